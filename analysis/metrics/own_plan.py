"""How often a method itself drives near pedestrians, rather than free driving or an emergency brake.

Counted are the plans that an ego makes during its encounters, until it has left the conflict area: in how
many the condition holds under which the method's source has it act (applies), the method's own plan is
carried out (acts), the command differs from that of free driving (deviates), and emergency braking, a last
check or a fallback has the last word (overridden). The controller says so itself, plan by plan.

Undefined: empty without such plans, and for controllers without a method for pedestrians;
method_acts_where_applies_share also if the condition never holds.
"""

from __future__ import annotations

from analysis.arrays import BoolArray
from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
OF_CONTROLLER = True
RUN_COLUMNS = (
    column.count("n_plans_near_ped", "plans made during encounters"),
    column.share("method_applies_share", "share of them in which the method's condition holds"),
    column.share("method_acts_share", "share of them in which the method's own plan is driven"),
    column.share("method_deviates_share", "share of them that differ from free driving"),
    column.share("method_overridden_share", "share of them in which braking or a fallback overrules"),
    column.share(
        "method_acts_where_applies_share",
        "share of the plans whose condition holds in which the method's own plan is driven",
    ),
)
_FLAGS = ("applies", "acts", "deviates", "overridden")


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the shares of the run."""
    rows = whole.near
    flags = whole.run.egos.flags
    near = rows[flags["planned"][rows]]
    said: dict[str, BoolArray] = {one: flags[f"method_{one}"][near] for one in _FLAGS}
    known = flags["method_stated"][near]
    if not known.any():
        return {"n_plans_near_ped": len(near)}
    shares = {f"method_{one}_share": float(flag[known].mean()) for one, flag in said.items()}
    applies = said["applies"] & known
    if applies.any():
        shares["method_acts_where_applies_share"] = float(said["acts"][applies].mean())
    return {"n_plans_near_ped": len(near), **shares}
