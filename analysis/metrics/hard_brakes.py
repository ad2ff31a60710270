"""Hard braking manoeuvres: stretches of steps with the ego braking harder than hard_brake_mps2.

Counted over all egos and the whole run, one for each uninterrupted stretch.

Undefined: never.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (column.count("n_hard_brake", "hard braking manoeuvres", required=True),)


def collect_rides(case: Case) -> Values:
    """Return the number of hard braking manoeuvres of each ego's track."""
    counts = []
    for track in case.egos:
        rows = track.rows[:: case.grid.factor]
        hard = case.steps.deceleration[rows] > case.thresholds.hard_brake_mps2
        counts.append(int((hard & ~np.concatenate([[False], hard[:-1]])).sum()))
    return {"counts": counts}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of hard braking manoeuvres."""
    return {"n_hard_brake": sum(columns["counts"])}
