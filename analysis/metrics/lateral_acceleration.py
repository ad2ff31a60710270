"""Largest lateral acceleration of the ego, until it has left the conflict area.

Speed times yaw rate, the yaw rate from the recorded headings of two steps.

Undefined: empty for encounters of a single step.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "m/s^2"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = (column.at_least_0("ego_max_lat_accel_mps2", "m/s^2", "largest lateral acceleration of the ego"),)


def compute(case: Case) -> Values:
    """Return the largest absolute lateral acceleration."""
    value = np.full(len(case), np.nan)
    for i, rows in enumerate(case.ego_rows):
        known = case.steps.lateral_acceleration[rows]
        known = known[np.isfinite(known)]
        if len(known):
            value[i] = np.abs(known).max()
    return {"ego_max_lat_accel_mps2": value}
