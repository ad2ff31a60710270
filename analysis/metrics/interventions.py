"""Steps at which SUMO did not do what the controller commanded, and why.

The recorded flag: after the step, SUMO's position of the ego differs from the plant's by more than 0.02 m, or
its speed from the one that it was told by more than 0.1 m/s, or SUMO has it on another way than its own or on
no lane. For an encounter: steps until the ego has left the conflict area. The causes are counted over the run
and add up to the total; recordings of earlier versions have none.

Undefined: never.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.recording.columns import INTERVENTIONS
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (column.count("n_interventions", "steps at which SUMO did something else", required=True),)
RUN_COLUMNS = (
    column.count("n_interventions", "steps at which SUMO did something else", required=True),
    *(
        column.count(f"n_interventions_{cause}", f"those in which {said}")
        for cause, said in INTERVENTIONS.items()
    ),
)


def compute(case: Case) -> Values:
    """Return the number of steps."""
    flag = case.run.egos.flags["intervention"]
    return {"n_interventions": np.array([int(flag[rows].sum()) for rows in case.ego_rows], dtype=np.int64)}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of steps in the run, all and by cause."""
    egos = whole.run.egos
    causes = egos.texts["intervention_cause"]
    return {
        "n_interventions": int(egos.flags["intervention"].sum()),
        **{f"n_interventions_{cause}": int(causes.equal(cause).sum()) for cause in INTERVENTIONS},
    }
