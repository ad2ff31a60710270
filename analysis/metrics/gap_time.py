"""Gap time: the predicted post-encroachment time when the first user leaves the conflict area.

GT = way of the second user to the area / its speed, both at the instant when the first one leaves;
that is PET if the second one neither brakes nor speeds up.

Undefined: empty without a conflict area, where both were inside at once, and where the second user
stands at that instant or is not recorded yet.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import ride_of
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "[Allen1978] after [SSAM2003], chapter 7"
COLUMNS = (
    column.at_least_0("gap_time_s", "s", "predicted arrival of the second user when the first one leaves"),
)


def compute(case: Case) -> Values:
    """Return the gap time."""
    gap = np.full(len(case), np.nan)
    for i, one in enumerate(case.encounters):
        if case.ego_enter[i] >= case.person_leave[i]:
            second, start, end = one.ego, case.person_leave[i], case.ego_enter[i]
        elif case.person_enter[i] >= case.ego_leave[i]:
            second, start, end = one.person, case.ego_leave[i], case.person_enter[i]
        else:
            continue
        ride = ride_of(case, second)
        speed = ride.speed_at(start)
        if start >= ride.time[0] and speed > 0.0:
            gap[i] = ride.way(start, end) / speed
    return {"gap_time_s": gap}
