"""Analyses recorded runs and writes their CSV files."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis import schema
from analysis.case import Case, prepare
from analysis.datapackage import describe
from analysis.errors import RecordingError
from analysis.recording.columns import SCHEMA_VERSION as RECORDING_VERSION
from analysis.recording.reading import read_run
from analysis.rows import Row, cells, encounter_and_run_rows, overlap_rows
from analysis.thresholds import Thresholds

CURVES = {
    "p_fatal_rosen2009": "P = 1 / (1 + exp(6.9 - 0.090 v)), v in km/h",
    "p_mais3_mm2025": (
        "P = 1 / (1 + exp(-eta)), eta = -0.460 + 0.091 (v - 42.79) + 0.039 (h - 85.25) "
        "+ 0.002 (v - 42.79) (h - 85.25), v in km/h, h = hood_leading_edge_cm"
    ),
}
"""Injury curves, echoed in config.json."""


@dataclass(frozen=True, slots=True)
class RunReport:
    """What the analysis of one run found, as written: undefined values are absent."""

    folder: Path
    run: Mapping[str, Any]
    encounters: Sequence[Mapping[str, Any]]
    overlaps: Sequence[Mapping[str, Any]]
    files: Sequence[Path]


@dataclass(frozen=True, slots=True)
class Failure:
    """A run folder that could not be analysed."""

    folder: Path
    reason: str


def analyse_run(folder: Path, thresholds: Thresholds | None = None) -> RunReport:
    """Read a recorded run, compute every metric and write the CSV files beside the recording.

    Raises
    ------
    RecordingError
        When the run cannot be read; nothing is written then.
    """
    thresholds = thresholds or Thresholds()
    case = prepare(read_run(folder), thresholds)
    encounters, run = encounter_and_run_rows(case)
    overlaps = overlap_rows(case)
    content = {
        schema.ENCOUNTERS.file: _csv(schema.ENCOUNTERS, encounters),
        schema.RUNS.file: _csv(schema.RUNS, [run]),
        schema.VEHICLE_OVERLAPS.file: _csv(schema.VEHICLE_OVERLAPS, overlaps),
        "config.json": _json(_config(case)),
        "datapackage.json": _json(describe(schema.TABLES, "one recorded run")),
    }
    files = [_write(folder / name, text) for name, text in content.items()]
    return RunReport(folder, run, encounters, overlaps, files)


def analyse_many(
    folders: Iterable[Path], thresholds: Thresholds | None = None
) -> tuple[list[RunReport], list[Failure]]:
    """Analyse each folder; one that cannot be read does not stop the others."""
    reports: list[RunReport] = []
    failures: list[Failure] = []
    for folder in folders:
        try:
            reports.append(analyse_run(folder, thresholds))
        except RecordingError as error:
            failures.append(Failure(folder, str(error)))
    return reports, failures


def _config(case: Case) -> dict[str, Any]:
    meta = case.run.meta
    return {
        "schema_version": schema.SCHEMA_VERSION,
        "recording_schema_version": RECORDING_VERSION,
        "run_id": meta["run_id"],
        "config_id": meta["config_id"],
        "scenario_id": meta["scenario_id"],
        "controller": meta["controller"],
        "parameters": meta.get("parameters"),
        "tool_version": meta.get("tool_version"),
        "sumo_version": meta.get("sumo_version"),
        "thresholds": case.thresholds.as_dict(),
        "thresholds_in_column_names": {
            "ttc_s": [1.0, 1.5, 3.0],
            "pet_s": [1.0, 1.5, 3.0, 5.0],
            "drac_mps2": [3.4],
        },
        "injury_curves": CURVES,
        "pedestrian_radius_m": sorted({round(0.5 * track.width, 6) for track in case.persons}),
        "ego_size_m": sorted({(round(t.length, 6), round(t.width, 6)) for t in case.egos}),
        "samples_per_step": case.grid.factor,
    }


def _csv(table: schema.Table, rows: Sequence[Row]) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(table.names())
    writer.writerows(cells(table, rows))
    return buffer.getvalue()


def _json(content: Mapping[str, Any]) -> str:
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _write(path: Path, text: str) -> Path:
    """Write a file so that one with its name is always complete."""
    part = path.with_name(path.name + ".part")
    part.write_text(text, "utf-8", newline="\n")
    part.replace(path)
    return path
