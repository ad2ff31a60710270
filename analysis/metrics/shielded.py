"""Plans that the controller's last check replaced by braking.

A controller that checks its plans before they are carried out names such a plan `shielded`. It is a safety
net, so few is good.

Undefined: never; 0 for controllers without such a check.
"""

from __future__ import annotations

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (column.count("n_shielded", "plans that the last check replaced by braking", required=True),)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the plans replaced by braking."""
    return {"n_shielded": int(whole.run.egos.texts["plan_status"].equal("shielded").sum())}
