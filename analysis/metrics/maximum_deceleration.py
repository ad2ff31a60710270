"""Largest deceleration of the ego, until it has left the conflict area.

From the recorded (realised) acceleration; positive while braking.

Undefined: never; 0 without braking.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m/s^2"
WORSE = "higher"
SOURCE = "[SSAM2008] (MaxD)"
COLUMNS = (
    column.at_least_0("ego_max_decel_mps2", "m/s^2", "largest deceleration of the ego", required=True),
)
RUN_COLUMNS = (
    column.at_least_0("max_decel_mps2", "m/s^2", "largest deceleration of any step", required=True),
)


def compute(case: Case) -> Values:
    """Return the largest deceleration."""
    braking = case.steps.deceleration
    return {"ego_max_decel_mps2": np.array([braking[rows].max(initial=0.0) for rows in case.ego_rows])}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the largest deceleration of all steps of the run."""
    return {"max_decel_mps2": whole.steps.deceleration.max(initial=0.0)}
