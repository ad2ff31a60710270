"""Mean speed of the egos: way over time, all egos together.

Undefined: empty when every ego was recorded for a single instant.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "m/s"
WORSE = "neither"
SOURCE = "own definition"
RUN_COLUMNS = (column.at_least_0("ego_mean_speed_mps", "m/s", "mean speed of the egos"),)


def compute(case: Case) -> Values:
    """Return the mean speed."""
    time = float(case.steps.duration.sum())
    return {"ego_mean_speed_mps": float(case.steps.distance.sum()) / time if time > 0.0 else None}
