"""Plans that the controller's last check replaced by braking.

A controller that checks its plans before they are carried out names such a plan `shielded`. It is a safety
net, so few is good.

Undefined: never; 0 for controllers without such a check.
"""

from __future__ import annotations

from analysis.case import Case, Values

SCOPE = "run"
UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = ()
RUN_COLUMNS = ("n_shielded",)


def compute(case: Case) -> Values:
    """Count them."""
    return {"n_shielded": int(case.run.egos.texts["plan_status"].equal("shielded").sum())}
