"""The measures of each run at each share, split into egos and all other vehicles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.encounters.severity_scale import CONFLICTS
from analysis.recording.columns import TRAFFIC
from analysis.results.exposure_rows import BICYCLE, EXPOSURE
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.study.runs import StudyRun

ALL, EGOS, OTHERS = WHO = ("all", "egos", "others")


@dataclass(frozen=True, slots=True)
class Measure:
    """One measure of the page."""

    name: str
    title: str
    unit: str
    split: bool = True
    """Whether egos and others have separate values."""


MEASURES = (
    Measure("met", "encounters in which somebody was in the way", "1/h"),
    Measure("conflicts", "conflicts, serious or worse", "per 100 encounters"),
    Measure("severe", "conflicts, severe or a collision", "per 100 encounters"),
    Measure("collisions", "collisions", "per 100 encounters"),
    Measure("conflicts_per_1000_ped", "conflicts", "per 1000 crossing pedestrians", split=False),
    Measure("ped_delay", "delay of pedestrians at crossings", "s", split=False),
    Measure("vehicle_delay", "delay of vehicles near crossings", "s/km"),
    Measure("throughput", "vehicles over crossings", "1/h", split=False),
    Measure("followers", "vehicles behind an ego with a TTC below 1.5 s", "per ego and hour", split=False),
)

Values = Mapping[tuple[str, str], float]
"""Values by measure and group of vehicles; nan if undefined."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The measures of one run."""

    scenario: str
    share: float
    seed: int
    values: Values


def outcomes(runs: Sequence[StudyRun]) -> list[Outcome]:
    """Return the measures of the valid runs, sorted by scenario, share and seed."""
    found = [
        Outcome(run.scenario_id, float(run.setting.get("ego_share", 0.0)), run.seed, _values(run))
        for run in runs
        if run.valid
    ]
    return sorted(found, key=lambda one: (one.scenario, one.share, one.seed))


def _values(run: StudyRun) -> Values:
    met = pd.read_csv(run.folder / TRAFFIC_ENCOUNTERS.file)
    used = pd.read_csv(run.folder / EXPOSURE.file)
    met = met[met["vehicle_class"] != BICYCLE]
    hours = float(used["observed_s"].max()) / 3600.0
    entered = met[met["entered"] == 1]
    values: dict[tuple[str, str], float] = {}
    for who in WHO:
        mine = entered if who == ALL else entered[entered["is_ego"] == (who == EGOS)]
        values["met", who] = len(mine) / hours
        for name, severities in (
            ("conflicts", CONFLICTS),
            ("severe", CONFLICTS[1:]),
            ("collisions", CONFLICTS[-1:]),
        ):
            values[name, who] = _ratio(100.0 * mine["severity"].isin(severities).sum(), len(mine))
    conflicts = met["severity"].isin(CONFLICTS).sum()
    values["conflicts_per_1000_ped", ALL] = _ratio(1000.0 * conflicts, used["n_pedestrians"].sum())
    values["ped_delay", ALL] = _ratio(used["ped_delay_sum_s"].sum(), used["n_ped_delay_defined"].sum())
    values["throughput", ALL] = used["n_vehicles"].sum() / hours
    values |= _delays(run.folder)
    ego_hours = run.numbers.get("ego_time_h", 0.0)
    values["followers", ALL] = _ratio(run.numbers.get("n_follower_ttc_lt_1p5", np.nan), ego_hours)
    return values


def _delays(folder: Path) -> Values:
    """Return the time that vehicles lose against the speed limit per kilometre near crossings [s/km]."""
    columns = ["object_kind", "vehicle_class", "is_ego", "x_speed_mps", "y_speed_mps", "speed_limit_mps"]
    rows = pd.read_parquet(folder / TRAFFIC.file, columns=columns)
    rows = rows[(rows["object_kind"] == "vehicle") & (rows["vehicle_class"] != BICYCLE)]
    speed = np.hypot(rows["x_speed_mps"], rows["y_speed_mps"])
    lost, is_ego = 1.0 - speed / rows["speed_limit_mps"], rows["is_ego"].astype(bool)
    found = {}
    for who, chosen in ((ALL, is_ego | ~is_ego), (EGOS, is_ego), (OTHERS, ~is_ego)):
        found["vehicle_delay", who] = _ratio(1000.0 * lost[chosen].sum(), speed[chosen].sum())
    return found


def _ratio(numerator: float, denominator: float) -> float:
    return float(numerator) / float(denominator) if denominator else float("nan")
