"""Time advantage: the smallest predicted time by which one user clears the area before the other.

At each sample both are extrapolated at constant velocity; TAdv is the predicted time between the first
one leaving the predicted conflict area and the second one entering it, 0 where they would be inside at
once. The smallest value while neither has left is reported.

Undefined: empty where the pedestrian never walks into the strip ahead of the ego, and for movement
along the ego's direction (use TTC).
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "[Laureshyn2010], with the conflict area in place of the point"
COLUMNS = (column.at_least_0("tadv_min_s", "s", "smallest predicted time advantage"),)


def compute(case: Case) -> Values:
    """Return the smallest time advantage."""
    area = case.predicted
    ahead = case.samples.exposed & ~area.longitudinal & ~np.isnan(area.person_in) & (area.ego_out > 0.0)
    ahead &= ~np.isinf(area.ego_in)
    clear = np.where(
        area.ego_out < area.person_in,
        area.person_in - np.where(ahead, area.ego_out, 0.0),
        np.maximum(np.where(ahead, area.ego_in, 0.0) - area.person_out, 0.0),
    )
    low, _ = case.samples.smallest(np.where(ahead, clear, np.inf))
    return {"tadv_min_s": low}
