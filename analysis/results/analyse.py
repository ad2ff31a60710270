"""Analyses recorded runs and writes their CSV files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.encounters.case import Case, prepare, prepare_traffic
from analysis.files import write_csv, write_json
from analysis.recording.columns import SCHEMA_VERSION as RECORDING_VERSION
from analysis.recording.reading import read_run
from analysis.recording.traffic import Traffic, has_traffic
from analysis.results.exposure_rows import EXPOSURE, Exposures
from analysis.results.metric_catalog import find_metrics
from analysis.results.origin import SCHEMA_VERSION
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.rows import conflict_rows, encounter_and_run_rows, overlap_rows
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS, Listing
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from analysis.sealing import seal
from analysis.tables.cells import Row, cell_rows, cells
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
    traffic = Traffic(recorded) if has_traffic(folder) else None
    case = prepare(recorded, thresholds)
    encounters, run = encounter_and_run_rows(case)
    overlaps = overlap_rows(case)
    tables: list[tuple[Table, Sequence[Row]]] = [
        (ENCOUNTERS, encounters),
        (RUNS, [run]),
        (VEHICLE_OVERLAPS, overlaps),
        (VEHICLE_CONFLICTS, conflict_rows(case)),
    ]
    everybody = [] if traffic is None else _write_traffic(folder, case, traffic)
    files = [write_csv(folder / table.file, table.names(), cells(table, rows)) for table, rows in tables]
    files += [folder / table.file for table in everybody]
    files.append(write_json(folder / "config.json", _config(case)))
    written = [*(table for table, _ in tables), *everybody]
    files.append(write_json(folder / "datapackage.json", describe(written, "one recorded run")))
    seal(folder, files)
    return RunReport(folder, run, encounters, overlaps, files)


def _write_traffic(folder: Path, egos: Case, traffic: Traffic) -> list[Table]:
    """Judge all traffic, part by part of its recording, and write its tables."""
    listing, exposures = Listing(egos, traffic.classes), Exposures(egos, traffic.classes)

    def encounters() -> Iterator[Row]:
        for part in traffic.parts():
            yield from listing.before(part.begin_s)
            others = prepare_traffic(part.run, egos.thresholds)
            listing.add(others)
            exposures.add(others, part.own_vehicles)
            del part, others  # or the next one would be read beside it
        yield from listing.before(math.inf)

    rows = cell_rows(TRAFFIC_ENCOUNTERS, encounters())
    write_csv(folder / TRAFFIC_ENCOUNTERS.file, TRAFFIC_ENCOUNTERS.names(), rows)
    write_csv(folder / EXPOSURE.file, EXPOSURE.names(), cells(EXPOSURE, exposures.rows()))
    return [TRAFFIC_ENCOUNTERS, EXPOSURE]


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
