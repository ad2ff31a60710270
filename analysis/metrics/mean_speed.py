"""Mean speed of the egos: way over time, all egos together.

Undefined: empty when every ego was recorded for a single instant.
"""

from __future__ import annotations

from analysis.case import Case, Values

SCOPE = "run"
UNIT = "m/s"
WORSE = "neither"
SOURCE = "own definition"
COLUMNS = ()
RUN_COLUMNS = ("ego_mean_speed_mps",)


def compute(case: Case) -> Values:
    """Return the mean speed."""
    time = float(case.steps.duration.sum())
    return {"ego_mean_speed_mps": float(case.steps.distance.sum()) / time if time > 0.0 else None}
