"""MaxS: the highest speed of either user while TTC is at most max_speed_ttc_s.

Undefined: empty where TTC never is that small.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "m/s"
WORSE = "higher"
SOURCE = "[SSAM2008]"
COLUMNS = (column.at_least_0("max_speed_mps", "m/s", "highest speed of either while TTC is low"),)


def compute(case: Case) -> Values:
    """Return the highest speed."""
    samples = case.samples
    close = samples.ttc <= case.thresholds.max_speed_ttc_s
    speed = np.where(close, np.maximum(samples.ego_speed, samples.person_speed), -np.inf)
    return {"max_speed_mps": samples.largest(speed)[0]}
