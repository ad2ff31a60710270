"""Mean speed of the egos: way over time, all egos together.

Undefined: empty when every ego was recorded for a single instant.
"""

from __future__ import annotations

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m/s"
WORSE = "neither"
SOURCE = "own definition"
RUN_COLUMNS = (column.at_least_0("ego_mean_speed_mps", "m/s", "mean speed of the egos"),)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the mean speed."""
    time = float(whole.steps.duration.sum())
    return {"ego_mean_speed_mps": float(whole.steps.distance.sum()) / time if time > 0.0 else None}
