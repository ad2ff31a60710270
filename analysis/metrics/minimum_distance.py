"""Smallest distance between the surfaces of ego and pedestrian.

The distance from the rectangle to the disc, 0 at contact, exact between samples: between two samples
the disc moves straight in the frame of the rectangle. Counted over the whole encounter, standing ego
and waiting pedestrian included (see `clearance` for the rest).

Undefined: never.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m"
WORSE = "lower"
SOURCE = "own definition; exact geometry in analysis/geometry.py"
COLUMNS = (
    column.at_least_0("min_dist_m", "m", "smallest distance between the surfaces", required=True),
    column.number("t_min_dist_s", "s", "when it was", required=True),
)
RUN_COLUMNS = (column.at_least_0("min_dist_m", "m", "smallest distance"),)


def compute(case: Case) -> Values:
    """Return the smallest distance and its time."""
    return {"min_dist_m": case.approach.distance, "t_min_dist_s": case.approach.time}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the smallest distance of the run."""
    distance = np.asarray(columns["min_dist_m"])
    return {"min_dist_m": distance.min() if len(distance) else None}
