"""T2: the smallest predicted time until the second user reaches the conflict area.

At each sample both are extrapolated at constant velocity; T2 is the later of the two predicted entries while
the first user has not left yet. On a collision course it is TTC.

Undefined: empty where the pedestrian never walks into the strip ahead of the ego, and where they move along
its direction without a collision course.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "[Laureshyn2010]; the formula is our reading of its text"
COLUMNS = (column.at_least_0("t2_min_s", "s", "smallest predicted time until the second user arrives"),)


def compute(case: Case) -> Values:
    """Return the smallest T2."""
    area, samples = case.predicted, case.samples
    known = samples.exposed & ~np.isnan(area.person_in) & (area.ego_out > 0.0) & ~np.isinf(area.ego_in)
    later = np.maximum(np.where(known, np.maximum(area.ego_in, area.person_in), np.inf), 0.0)
    t2 = np.where(np.isfinite(samples.ttc), samples.ttc, np.where(area.longitudinal, np.inf, later))
    low, _ = samples.smallest(np.where(samples.exposed, t2, np.inf))
    return {"t2_min_s": low}
