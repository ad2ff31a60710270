"""Time the pedestrian stood at the kerb before the crossing.

The time with phase waiting and a speed below pedestrian_standing_speed_mps, until the pedestrian steps
on the crossing or the encounter ends. An earlier walk over the same crossing, and the waiting before it, do
not count.

Undefined: empty away from crossings. The time is what was recorded: pedestrians already waiting when they
came into range waited longer.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.crossing_walks import after_earlier_walk
from analysis.encounters.moments import crossing_stay, phase_samples
from analysis.tables import column

UNIT = "s"
WORSE = "higher"
SOURCE = "[HCM2010], waiting part of the delay"
COLUMNS = (column.at_least_0("ped_wait_s", "s", "time the pedestrian stood at the kerb"),)


def compute(case: Case) -> Values:
    """Return the waiting time."""
    wait = np.full(len(case), np.nan)
    for i, one in enumerate(case.encounters):
        if not one.crossing_id:
            continue
        stay = crossing_stay(case, one)
        end = one.last - one.person.first if stay is None else stay[0]
        standing = one.person.speed[:end] < case.thresholds.pedestrian_standing_speed_mps
        waiting = phase_samples(case, one, "waiting")[:end] & standing
        waiting[: after_earlier_walk(phase_samples(case, one, "crossing"), end)] = False
        time = case.grid.time[one.person.first : one.person.first + end + 1]
        wait[i] = np.diff(time)[waiting[: len(time) - 1]].sum()
    return {"ped_wait_s": wait}
