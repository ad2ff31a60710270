"""Conflicts per vehicle-kilometre and per 1000 pedestrians.

A conflict is an encounter of severity serious, severe or collision; the way is that of all egos, the
pedestrians are all that were in some encounter.

Undefined: empty without way, or without pedestrians.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.severity_scale import CONFLICTS, severity_levels
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1/km"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (
    column.count("n_conflicts", "encounters of severity serious or worse", required=True),
    column.at_least_0("conflicts_per_veh_km", "1/km", "those per way of the egos"),
    column.at_least_0("conflicts_per_1000_ped", "1", "those per 1000 pedestrians"),
)


def collect_encounters(case: Case) -> Values:
    """Return the level of each conflict of a part of the run."""
    return {"conflicts": [level for level in severity_levels(case) if level in CONFLICTS]}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of conflicts and both rates."""
    conflicts = len(columns["conflicts"])
    kilometres = float(whole.steps.distance.sum()) / 1000.0
    persons = len({one.person_id for one in whole.encounters})
    return {
        "n_conflicts": conflicts,
        "conflicts_per_veh_km": conflicts / kilometres if kilometres > 0.0 else None,
        "conflicts_per_1000_ped": 1000.0 * conflicts / persons if persons else None,
    }
