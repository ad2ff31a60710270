"""How often each decision rule was taken.

Number of plans made under STRAIGHT, LANE CHANGE and AUTONOMOUS. For an encounter: until the ego has left the
conflict area.

Undefined: never; all 0 for controllers without these rules.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "Eqs. (26)-(31) of [VOMPC2019]"
OF_CONTROLLER = True
COLUMNS = (
    column.count("n_straight", "plans under the rule STRAIGHT", required=True),
    column.count("n_lane_change", "plans under the rule LANE CHANGE", required=True),
    column.count("n_autonomous", "plans under the rule AUTONOMOUS", required=True),
)
RUN_COLUMNS = (
    column.count("n_straight", "plans under the rule STRAIGHT", required=True),
    column.count("n_lane_change", "plans under the rule LANE CHANGE", required=True),
    column.count("n_autonomous", "plans under the rule AUTONOMOUS", required=True),
)

_RULES = ("straight", "lane_change", "autonomous")


def compute(case: Case) -> Values:
    """Return the number of plans under each rule."""
    rule = case.run.egos.texts["rule"]
    return {
        f"n_{name}": np.array([int(rule.equal(name, rows).sum()) for rows in case.ego_rows], dtype=np.int64)
        for name in _RULES
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the numbers of the run."""
    rule = whole.run.egos.texts["rule"]
    return {f"n_{name}": int(rule.equal(name).sum()) for name in _RULES}
