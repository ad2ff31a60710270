"""Whether the pedestrian entered inside the ego's comfort stopping distance.

1 where, at the instant the pedestrian steps on the crossing (away from crossings: at the encounter's
beginning), the way to the conflict area is less than v^2 / (2 a) with comfort_deceleration_mps2.

Undefined: with or without a contact, empty where there is no conflict area, or where the ego was in it
before the pedestrian could be seen to enter.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import entries
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
COLUMNS = (
    column.flag(
        "late_entry",
        "the pedestrian entered inside the ego's comfort stopping distance; empty where undefined",
    ),
)
RUN_COLUMNS = (column.count("n_late_entries", "encounters with a late entry", required=True),)


def compute(case: Case) -> Values:
    """Return 1, 0, or nan where it is undefined."""
    seen = entries(case)
    needed = seen.ego_speed**2 / (2.0 * case.thresholds.comfort_deceleration_mps2)
    return {"late_entry": np.where(np.isnan(seen.time), np.nan, seen.distance < needed)}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count late entries."""
    return {"n_late_entries": int(np.nansum(columns["late_entry"]))}
