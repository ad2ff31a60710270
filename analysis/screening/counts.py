"""Counts what happened at each crossing in each run of a study that recorded everybody."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.severity_scale import CONFLICTS
from analysis.errors import StudyError
from analysis.files import read_csv
from analysis.metrics.injury_risk_rosen2009 import risk
from analysis.results.exposure_rows import BICYCLE, EXPOSURE
from analysis.results.run_tables import RUNS
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.screening.consequences import Risks
from analysis.screening.ranking import Counted

_USED = (
    *("n_pedestrians", "n_vehicles", "n_cyclists", "n_red_light_walkers"),
    *("n_ped_delay_defined", "ped_delay_sum_s", "observed_s"),
)
_SPEEDS = ("vehicle_speed_mean_mps", "vehicle_speed_p85_mps")
_FATAL = ("p_fatal_sum", "p_fatal_squares", "n_p_fatal_defined")
_MET = (
    *_FATAL,
    *("encounters", "entered", "conflicts", "severe", "collisions"),
    *("yields", "yieldable", "late", "late_defined", "hidden", "cyclist_encounters", "cyclist_conflicts"),
)

Cells = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Counts:
    """Counts by crossing and run, both in a fixed order."""

    crossings: Sequence[Cells]
    """One row of crossing_exposure.csv for each crossing, for facts that are the same in all runs."""
    seeds: Sequence[int]
    each: Mapping[str, FloatArray]
    """Counts by name, shape (crossings, runs)."""
    ttc: Sequence[FloatArray]
    """For each crossing, the defined smallest TTCs of motor vehicles' encounters [s]."""
    pet: Sequence[FloatArray]
    speeds: Mapping[str, FloatArray]
    """Mean over runs of a speed of motor vehicles, shape (crossings,); nan without vehicles [m/s]."""

    def total(self, name: str) -> FloatArray:
        """Return the sum over runs, shape (crossings,)."""
        return np.asarray(self.each[name].sum(axis=1))

    def counted(self, runs: Sequence[int] | None = None) -> Counted:
        """Return what a ranking needs, from some columns of ``each`` or from all."""
        chosen = slice(None) if runs is None else list(runs)
        risks = Risks(*(self.each[name][:, chosen] for name in _FATAL))
        return Counted(self.each["conflicts"][:, chosen], self.each["n_pedestrians"][:, chosen], risks)


def read_counts(folder: Path) -> Counts:
    """Return the counts over the valid runs in a study's folder.

    Raises
    ------
    StudyError
        If there is no valid run, or none recorded everybody.
    """
    valid = {row["run_id"] for row in read_csv(folder / RUNS.file) if row["valid"] == "1"}
    try:
        used = [row for row in read_csv(folder / EXPOSURE.file) if row["run_id"] in valid]
    except FileNotFoundError:
        raise StudyError(f"{folder}: no run of it recorded everybody") from None
    if not used:
        raise StudyError(f"{folder}: no valid run in which a crossing was recorded")
    seeds = sorted({int(row["seed"]) for row in used})
    facts = {row["crossing_id"]: row for row in used}
    names = sorted(facts)
    place = {name: number for number, name in enumerate(names)}
    column = {seed: number for number, seed in enumerate(seeds)}
    shape = (len(names), len(seeds))
    each = {name: np.zeros(shape) for name in (*_USED, *_MET, "vehicle_speed_sum_mps")}
    for row in used:
        at = place[row["crossing_id"]], column[int(row["seed"])]
        for name in _USED:
            each[name][at] = float(row[name])
        if row["vehicle_speed_mean_mps"]:
            total = float(row["n_vehicles"]) * float(row["vehicle_speed_mean_mps"])
            each["vehicle_speed_sum_mps"][at] = total
    ttc: list[list[float]] = [[] for _ in names]
    pet: list[list[float]] = [[] for _ in names]
    for row in read_csv(folder / TRAFFIC_ENCOUNTERS.file):
        if row["run_id"] in valid and row["crossing_id"] in place:
            number = place[row["crossing_id"]]
            _count(row, each, (number, column[int(row["seed"])]))
            if row["vehicle_class"] != BICYCLE and row["entered"] == "1":
                _append(ttc[number], row["min_ttc_s"])
                _append(pet[number], row["pet_area_s"])
    speeds = {name: _mean_over_runs(used, place, name) for name in _SPEEDS}
    ttcs, pets = ([np.array(values) for values in some] for some in (ttc, pet))
    return Counts([facts[name] for name in names], seeds, each, ttcs, pets, speeds)


def _count(row: Cells, each: Mapping[str, FloatArray], at: tuple[int, int]) -> None:
    conflict = row["severity"] in CONFLICTS
    if row["vehicle_class"] == BICYCLE:
        each["cyclist_encounters"][at] += 1
        each["cyclist_conflicts"][at] += conflict
        return
    each["encounters"][at] += 1
    each["entered"][at] += row["entered"] == "1"
    each["conflicts"][at] += conflict
    each["severe"][at] += row["severity"] in CONFLICTS[1:]
    each["collisions"][at] += row["severity"] == CONFLICTS[-1]
    each["yieldable"][at] += row["yielded"] != ""
    each["yields"][at] += row["yielded"] == "1"
    each["late_defined"][at] += row["late_entry"] != ""
    each["late"][at] += row["late_entry"] == "1"
    if row["entered"] == "1" and row["conflicting_speed_mps"]:
        p_fatal = risk(3.6 * float(row["conflicting_speed_mps"]))
        each["p_fatal_sum"][at] += p_fatal
        each["p_fatal_squares"][at] += p_fatal**2
        each["n_p_fatal_defined"][at] += 1
    each["hidden"][at] += row.get("hidden_before_conflict") == "1"  # older studies lack it


def _append(values: list[float], cell: str) -> None:
    if cell:
        values.append(float(cell))


def _mean_over_runs(used: Sequence[Cells], place: Mapping[str, int], name: str) -> FloatArray:
    total, vehicles = np.zeros(len(place)), np.zeros(len(place))
    for row in used:
        if row[name]:
            count = float(row["n_vehicles"])
            total[place[row["crossing_id"]]] += count * float(row[name])
            vehicles[place[row["crossing_id"]]] += count
    return np.asarray(np.divide(total, vehicles, out=np.full(len(place), np.nan), where=vehicles > 0.0))
