"""Analyses recorded runs and writes their CSV files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.encounters.case import Case, prepare, prepare_traffic
from analysis.files import write_csv, write_json
from analysis.recording.columns import SCHEMA_VERSION as RECORDING_VERSION
from analysis.recording.reading import read_run
from analysis.recording.traffic import has_traffic, read_traffic
from analysis.results.exposure_rows import EXPOSURE, exposure_rows
from analysis.results.metric_catalog import find_metrics
from analysis.results.origin import SCHEMA_VERSION
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.rows import conflict_rows, encounter_and_run_rows, overlap_rows
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS, traffic_rows
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from analysis.sealing import seal
from analysis.tables.cells import Row, cells
from analysis.tables.column import Table
from analysis.tables.datapackage import describe
from analysis.thresholds import DRAC_LIMIT_MPS2, PET_LIMITS_S, TTC_LIMITS_S, Thresholds


@dataclass(frozen=True, slots=True)
class RunReport:
    """Results of the analysis of one run, as written: undefined values are absent."""

    folder: Path
    run: Mapping[str, Any]
    encounters: Sequence[Mapping[str, Any]]
    overlaps: Sequence[Mapping[str, Any]]
    files: Sequence[Path]


def analyse_run(folder: Path, thresholds: Thresholds | None = None) -> RunReport:
    """Read a recorded run, compute every metric and write the CSV files beside the recording.

    Raises
    ------
    RecordingError
        When the run cannot be read; nothing is written then.
    """
    thresholds = thresholds or Thresholds()
    recorded = read_run(folder)
    traffic = read_traffic(recorded) if has_traffic(folder) else None
    case = prepare(recorded, thresholds)
    encounters, run = encounter_and_run_rows(case)
    overlaps = overlap_rows(case)
    tables: list[tuple[Table, Sequence[Row]]] = [
        (ENCOUNTERS, encounters),
        (RUNS, [run]),
        (VEHICLE_OVERLAPS, overlaps),
        (VEHICLE_CONFLICTS, conflict_rows(case)),
    ]
    if traffic is not None:
        others = prepare_traffic(traffic.run, thresholds)
        tables.append((TRAFFIC_ENCOUNTERS, traffic_rows(case, others, traffic.classes)))
        tables.append((EXPOSURE, exposure_rows(case, others, traffic.classes)))
    files = [write_csv(folder / table.file, table.names(), cells(table, rows)) for table, rows in tables]
    files.append(write_json(folder / "config.json", _config(case)))
    written = [table for table, _ in tables]
    files.append(write_json(folder / "datapackage.json", describe(written, "one recorded run")))
    seal(folder, files)
    return RunReport(folder, run, encounters, overlaps, files)


def _config(case: Case) -> dict[str, Any]:
    meta = case.run.meta
    return {
        "schema_version": SCHEMA_VERSION,
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
            "ttc_s": TTC_LIMITS_S,
            "pet_s": PET_LIMITS_S,
            "drac_mps2": [DRAC_LIMIT_MPS2],
        },
        "injury_curves": dict(
            sorted((metric.columns[0].name, metric.curve) for metric in find_metrics() if metric.curve)
        ),
        "pedestrian_radius_m": sorted({round(0.5 * track.width, 6) for track in case.persons}),
        "ego_size_m": sorted({(round(t.length, 6), round(t.width, 6)) for t in case.egos}),
        "samples_per_step": case.grid.factor,
    }
