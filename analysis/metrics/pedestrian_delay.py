"""Delay of the pedestrian: waiting at the kerb and slowing down on the crossing.

The integral of (1 − v / v_free) over the time waiting for and on the crossing, where v < v_free; v_free
is the free_walking_percentile of the pedestrian's own recorded speeds while walking. An earlier walk over
the same crossing, and the waiting before it, do not count. The run's mean counts each person once for each
crossing, with the last walk, and its level of service follows it: A below 5 s, B below 10, C below 20,
D below 30, E below 45, else F.

Undefined: empty for a person who is not seen to leave the crossing.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.crossing_walks import after_earlier_walk
from analysis.encounters.crossing_walks import delay as delay_of_walk
from analysis.encounters.finding import place_in_run
from analysis.encounters.hcm import level_of_service
from analysis.encounters.moments import crossing_stay, phase_samples
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "s"
WORSE = "higher"
SOURCE = "[HCM2010]; measured, not its formula"
COLUMNS = (column.at_least_0("ped_delay_s", "s", "delay of the pedestrian"),)
RUN_COLUMNS = (
    column.count("n_ped_delay_defined", "pedestrians and crossings with a delay", required=True),
    column.at_least_0("ped_delay_mean_s", "s", "mean delay of pedestrians"),
    column.at_least_0("ped_delay_p95_s", "s", "95th percentile of it"),
    column.text("ped_los_hcm2010", "level of service by mean delay", "A", "B", "C", "D", "E", "F"),
)


def compute(case: Case) -> Values:
    """Return the delay."""
    delay = np.full(len(case), np.nan)
    for i, one in enumerate(case.encounters):
        stay = crossing_stay(case, one)
        if stay is not None:
            inside = phase_samples(case, one, "waiting", "crossing")
            since = after_earlier_walk(phase_samples(case, one, "crossing"), stay[0])
            delay[i] = delay_of_walk(one.person, inside, since, stay[1], case.grid, case.thresholds)
    return {"ped_delay_s": delay}


def collect_encounters(case: Case) -> Values:
    """Return when the walk of each encounter began, by the encounter's place in the run."""
    return {
        "began": [
            (place_in_run(one), float(case.grid.time[one.person.first + stay[0]]))
            for one in case.encounters
            if (stay := crossing_stay(case, one)) is not None
        ]
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return mean and 95th percentile over persons and crossings, and the level of service."""
    values, began = np.asarray(columns["ped_delay_s"]), dict(columns["began"])
    last: dict[tuple[str, str], tuple[float, float]] = {}
    for one, value in zip(whole.encounters, values.tolist(), strict=True):
        if value == value:
            key = one.person_id, one.crossing_id
            last[key] = max(last.get(key, (-np.inf, 0.0)), (began[one.place], value))
    if not last:
        return {"n_ped_delay_defined": 0}
    known = np.array([value for _, value in last.values()])
    mean = float(known.mean())
    return {
        "n_ped_delay_defined": len(known),
        "ped_delay_mean_s": mean,
        "ped_delay_p95_s": np.percentile(known, 95.0),
        "ped_los_hcm2010": level_of_service(mean),
    }
