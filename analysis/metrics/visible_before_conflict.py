"""How long the ego had been told of the pedestrian, without a break, when the conflict came.

The conflict comes at the first collision, without one when the second of the two enters the conflict area.
0 where the ego was not told of the pedestrian at that instant. Pedestrians who are extrapolated through a
short loss count as told.

Undefined: empty where the sensing is perfect, without a conflict area, and where one of the two never
enters it.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.recording.knowledge import NOTHING
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (
    column.at_least_0(
        "visible_before_conflict_s",
        "s",
        "time for which the ego had been told of the pedestrian; empty where it knew",
    ),
)


def compute(case: Case) -> Values:
    """Return the time, or nan where it is undefined [s]."""
    values = np.full(len(case), np.nan)
    conflict = np.maximum(case.ego_enter, case.person_enter)
    for i, contact in enumerate(case.first_collision()):
        instant = float(conflict[i]) if contact is None else contact.time
        if case.knowledge is None or np.isnan(instant):
            continue
        one = case.encounters[i]
        known = case.knowledge.get((one.ego.name, one.person.name), NOTHING)
        values[i] = np.nan_to_num(instant - known.since(instant))
    return {"visible_before_conflict_s": values}
