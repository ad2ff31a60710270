"""Clearance: the smallest distance while the ego moves and the pedestrian is on the road.

As minimum_distance, but only over samples with the ego faster than moving_speed_mps and the pedestrian
on the crossing (or anywhere in an encounter away from crossings). Percentiles of a run are those of its
encounters with a defined value.

Undefined: empty where there is no such sample.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values
from analysis.contacts import closest_approaches

SCOPE = "encounter"
UNIT = "m"
WORSE = "lower"
SOURCE = "own definition"
COLUMNS = ("clearance_min_m",)
RUN_COLUMNS = ("n_clearance_defined", "clearance_min_m", "clearance_p01_m", "clearance_p05_m")


def compute(case: Case) -> Values:
    """Return the smallest clearance."""
    moving = case.samples.exposed & (case.samples.ego_speed > case.thresholds.moving_speed_mps)
    return {"clearance_min_m": closest_approaches(case.samples, moving).distance}


def summarise(case: Case, columns: Values) -> Values:
    """Return smallest value and low percentiles of the defined ones."""
    values = np.asarray(columns["clearance_min_m"])
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return {"n_clearance_defined": 0}
    return {
        "n_clearance_defined": len(known),
        "clearance_min_m": known.min(),
        "clearance_p01_m": np.percentile(known, 1.0),
        "clearance_p05_m": np.percentile(known, 5.0),
    }
