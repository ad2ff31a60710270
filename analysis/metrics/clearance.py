"""Clearance: the smallest distance while the ego moves and the pedestrian is on the road.

As minimum_distance, but only over samples with the ego faster than moving_speed_mps and the pedestrian
on the crossing (or anywhere in an encounter away from crossings). Percentiles of a run are those of its
encounters with a defined value.

Undefined: empty where there is no such sample.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.contacts import closest_approaches
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m"
WORSE = "lower"
SOURCE = "own definition"
COLUMNS = (
    column.at_least_0(
        "clearance_min_m", "m", "smallest distance with the ego moving and the pedestrian on the road"
    ),
)
RUN_COLUMNS = (
    column.count("n_clearance_defined", "encounters with a clearance", required=True),
    column.at_least_0("clearance_min_m", "m", "smallest clearance"),
    column.at_least_0("clearance_p01_m", "m", "1st percentile of the encounters' clearance"),
    column.at_least_0("clearance_p05_m", "m", "5th percentile of the encounters' clearance"),
)


def compute(case: Case) -> Values:
    """Return the smallest clearance."""
    moving = case.samples.exposed & (case.samples.ego_speed > case.thresholds.moving_speed_mps)
    return {"clearance_min_m": closest_approaches(case.samples, moving).distance}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the smallest value and low percentiles over the encounters with a defined value."""
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
