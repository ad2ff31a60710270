"""Plans that were not the wanted one, because the problem was not solved.

A controller then uses its declared fallback. For an encounter: plans until the ego has left the conflict
area. controller_status of an encounter: `ok`, `timeout` where the name of a fallback says so, else
`infeasible`.

Undefined: never; 0 for controllers that solve nothing.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (
    column.text(
        "controller_status", "whether every plan was solved", "ok", "infeasible", "timeout", required=True
    ),
)
RUN_COLUMNS = (
    column.count("n_plans", "plans made", required=True, worse="neither"),
    column.count("n_solver_fail", "plans that were not solved", required=True),
)


def compute(case: Case) -> Values:
    """Return the status of each encounter."""
    failed = case.run.egos.flags["planned"] & ~case.run.egos.flags["solved"]
    names = case.run.egos.texts["plan_status"]
    status = []
    for rows in case.ego_rows:
        bad = rows[failed[rows]]
        late = any("time" in names.at(int(row)) for row in bad)
        status.append("ok" if len(bad) == 0 else "timeout" if late else "infeasible")
    return {"controller_status": status}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the plans, and the plans that were not solved."""
    planned = whole.run.egos.flags["planned"]
    return {
        "n_plans": int(planned.sum()),
        "n_solver_fail": int((planned & ~whole.run.egos.flags["solved"]).sum()),
    }
