"""DeltaS: the length of the velocity of one user relative to the other at the smallest TTC.

At first contact after a collision.

Undefined: empty without a collision course.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "m/s"
WORSE = "higher"
SOURCE = "[SSAM2008]"
COLUMNS = (column.at_least_0("delta_s_mps", "m/s", "relative speed at the smallest TTC"),)


def compute(case: Case) -> Values:
    """Return the relative speed."""
    samples = case.samples
    low, at = samples.smallest(samples.ttc)
    relative = np.hypot(samples.relative_x_speed, samples.y_speed)
    value = np.where(np.isfinite(low), relative[at] if len(at) else low, np.nan)
    for contact in reversed(case.collisions()):
        value[contact.encounter] = contact.relative_speed
    return {"delta_s_mps": value}
