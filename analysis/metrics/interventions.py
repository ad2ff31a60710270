"""Steps at which SUMO did not do what the controller commanded.

The recorded flag: after the step SUMO's position or speed of the ego differs from the plant's by more
than 0.02 m or 0.1 m/s. For an encounter: steps until the ego has left the conflict area.

Undefined: never.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = ("n_interventions",)
RUN_COLUMNS = ("n_interventions",)


def compute(case: Case) -> Values:
    """Return the number of steps."""
    flag = case.run.egos.flags["intervention"]
    return {"n_interventions": np.array([int(flag[rows].sum()) for rows in case.ego_rows], dtype=np.int64)}


def summarise(case: Case, columns: Values) -> Values:
    """Return the number of steps in the run."""
    return {"n_interventions": int(case.run.egos.flags["intervention"].sum())}
