"""Close pass: the highest speed of the ego while it is nearer than close_pass_m to the pedestrian.

Counted for a run are the encounters in which it is above close_pass_speed_mps, contacts among them.

Undefined: empty where the ego never is that near.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m/s"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = (
    column.at_least_0(
        "close_pass_speed_mps", "m/s", "highest speed of the ego while nearer than close_pass_m"
    ),
)
RUN_COLUMNS = (column.count("n_close_passes", "encounters passed too close and too fast", required=True),)


def compute(case: Case) -> Values:
    """Return the highest speed."""
    samples = case.samples
    near = samples.clearance < case.thresholds.close_pass_m
    return {"close_pass_speed_mps": samples.largest(np.where(near, samples.ego_speed, -np.inf))[0]}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of close passes."""
    fast = np.asarray(columns["close_pass_speed_mps"]) > whole.thresholds.close_pass_speed_mps
    return {"n_close_passes": int(np.count_nonzero(fast))}
