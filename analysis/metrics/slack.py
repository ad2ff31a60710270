"""Share of plans that had to violate a soft constraint by more than slack_m.

Undefined: empty without plans.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (column.at_least_0("slack_share", "1", "share of plans that violated a soft constraint"),)
RUN_COLUMNS = (column.at_least_0("slack_share", "1", "share of plans that violated a soft constraint"),)


def compute(case: Case) -> Values:
    """Return the share of each encounter."""
    return {"slack_share": np.array([_share(case, rows) for rows in case.ego_rows])}


def summarise(case: Case, columns: Values) -> Values:
    """Return the share of the run."""
    return {"slack_share": _share(case, np.arange(len(case.run.egos)))}


def _share(case: Case, rows: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> float:
    planned = rows[case.run.egos.flags["planned"][rows]]
    if len(planned) == 0:
        return np.nan
    return float((case.run.egos.numbers["slack_m"][planned] > case.thresholds.slack_m).mean())
