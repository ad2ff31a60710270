"""Analyses recorded runs and writes their CSV files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.arrays import IntArray
from analysis.encounters.case import Case, prepare_in_parts, prepare_traffic
from analysis.encounters.whole_run import WholeRun
from analysis.errors import RecordingError
from analysis.files import write_csv, write_json
from analysis.recording.columns import SCHEMA_VERSION as RECORDING_VERSION
from analysis.recording.fine_grid import samples_per_step
from analysis.recording.reading import read_rides
from analysis.recording.rides import Rides
from analysis.recording.traffic import Traffic, has_traffic
from analysis.results.exposure_rows import EXPOSURE, Exposures
from analysis.results.metric_catalog import find_metrics
from analysis.results.origin import SCHEMA_VERSION
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.rows import Judgement
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
        If the run cannot be read, or memory does not suffice; nothing is written then.
    """
    try:
        return _analysed(folder, thresholds or Thresholds())
    except MemoryError:
        raise RecordingError(
            f"{folder}: there is not enough memory to judge it; the recording is kept, and cosim analyse "
            "judges it where there is more"
        ) from None


def _analysed(folder: Path, thresholds: Thresholds) -> RunReport:
    rides = Rides(read_rides(folder), thresholds)
    everybody = _Everybody(Traffic(rides.run)) if has_traffic(folder) else None
    judgement = Judgement(rides.run, thresholds)
    for part in rides.parts():
        for number, case in enumerate(prepare_in_parts(part.run, thresholds)):
            if number == 0:
                judgement.add_rides(case, part.rows)
            judgement.add_encounters(case, part.rows)
            if everybody is not None:
                everybody.add_egos(case, number == 0)
            del case  # frees memory before the next one is made
        del part
    judged = judgement.judged()
    run, overlaps = judged.run_row(), judged.overlap_rows()
    tables: list[tuple[Table, Sequence[Row]]] = [
        (ENCOUNTERS, judged.encounters),
        (RUNS, [run]),
        (VEHICLE_OVERLAPS, overlaps),
        (VEHICLE_CONFLICTS, judged.conflict_rows()),
    ]
    others = [] if everybody is None else everybody.write(folder, judged.order, thresholds)
    files = [write_csv(folder / table.file, table.names(), cell_rows(table, rows)) for table, rows in tables]
    files += [folder / table.file for table in others]
    files.append(write_json(folder / "config.json", _config(judged.whole)))
    written = [*(table for table, _ in tables), *others]
    files.append(write_json(folder / "datapackage.json", describe(written, "one recorded run")))
    seal(folder, files)
    return RunReport(folder, run, judged.encounters, overlaps, files)


class _Everybody:
    """Judges all traffic of a run, one part of the recording after the other: egos first, then all others."""

    def __init__(self, traffic: Traffic) -> None:
        self._traffic = traffic
        self._listing, self._exposures = Listing(traffic.classes), Exposures(traffic.run, traffic.classes)

    def add_egos(self, case: Case, rides: bool) -> None:
        """Add the encounters of a case and, once for each ego, the crossings over which it drove."""
        self._listing.add_egos(case)
        if rides:
            self._exposures.add_egos(case)

    def write(self, folder: Path, order: IntArray, thresholds: Thresholds) -> list[Table]:
        """Judge the other vehicles and write the tables; ``order`` is the order of the egos' encounters."""
        self._listing.number_egos(order)
        rows = cell_rows(TRAFFIC_ENCOUNTERS, self._encounters(thresholds))
        write_csv(folder / TRAFFIC_ENCOUNTERS.file, TRAFFIC_ENCOUNTERS.names(), rows)
        write_csv(folder / EXPOSURE.file, EXPOSURE.names(), cells(EXPOSURE, self._exposures.rows()))
        return [TRAFFIC_ENCOUNTERS, EXPOSURE]

    def _encounters(self, thresholds: Thresholds) -> Iterator[Row]:
        for part in self._traffic.parts():
            yield from self._listing.before(part.begin_s)
            others = prepare_traffic(part.run, thresholds)
            self._listing.add(others)
            self._exposures.add(others, part.own_vehicles)
            del part, others  # frees memory before the next one is read
        yield from self._listing.before(math.inf)


def _config(whole: WholeRun) -> dict[str, Any]:
    meta = whole.run.meta
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
        "thresholds": whole.thresholds.as_dict(),
        "thresholds_in_column_names": {
            "ttc_s": TTC_LIMITS_S,
            "pet_s": PET_LIMITS_S,
            "drac_mps2": [DRAC_LIMIT_MPS2],
        },
        "injury_curves": dict(
            sorted((metric.columns[0].name, metric.curve) for metric in find_metrics() if metric.curve)
        ),
        "pedestrian_radius_m": sorted({round(0.5 * width, 6) for width in whole.pedestrian_widths}),
        "ego_size_m": sorted({(round(length, 6), round(width, 6)) for length, width in whole.ego_sizes}),
        "samples_per_step": samples_per_step(whole.run, whole.thresholds),
    }
