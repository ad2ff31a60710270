"""Whether another vehicle hid the pedestrian from the driver within the last 2 s before a conflict.

For encounters of severity serious or worse: 1 if, at some sample of the last 2 s before the conflict, the
straight line from the driver's eye (2 m behind the middle of the front bumper) to the pedestrian's centre was
cut by the rectangle of another recorded vehicle, of any height. The conflict is the first collision, without
one the instant of the smallest TTC, without one the later entry into the conflict area. Walls, hedges and
whatever else the recording does not hold hide nobody.

Undefined: empty for encounters of less severity.
"""

from __future__ import annotations

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.careful_driver import eye_of
from analysis.encounters.case import Case, Values
from analysis.encounters.line_of_sight import is_visible
from analysis.encounters.severity_scale import CONFLICTS, severity_levels
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = (
    column.flag(
        "hidden_before_conflict",
        "another vehicle hid the pedestrian from the driver in the last 2 s before the conflict; empty "
        "without a conflict",
    ),
)
RUN_COLUMNS = (
    column.count(
        "n_hidden_before_conflict", "conflicts with a pedestrian hidden by a vehicle", required=True
    ),
)

_BEFORE_S = 2.0


def compute(case: Case) -> Values:
    """Return 1, 0, or nan where it is undefined."""
    values = np.full(len(case), np.nan)
    instants = _instants(case)
    for i, level in enumerate(severity_levels(case)):
        if level in CONFLICTS:
            values[i] = _hidden(case, i, float(instants[i]))
    return {"hidden_before_conflict": values}


def _instants(case: Case) -> FloatArray:
    low, at = case.samples.smallest(case.samples.ttc)
    found = np.fmax(case.ego_enter, case.person_enter)
    for i in np.flatnonzero(np.isfinite(low)).tolist():
        found[i] = case.samples.time[at[i]]
    for i, contact in enumerate(case.first_collision()):
        if contact is not None:
            found[i] = contact.time
    return found


def _hidden(case: Case, i: int, instant: float) -> bool:
    ego, person = case.encounters[i].ego, case.encounters[i].person
    time = case.grid.time
    first = max(ego.first, person.first, int(np.searchsorted(time, instant - _BEFORE_S)))
    last = min(ego.last, person.last, int(np.searchsorted(time, instant)))
    if first > last:
        return False
    own = slice(first - ego.first, last - ego.first + 1)
    there = slice(first - person.first, last - person.first + 1)
    others = [one for one in case.bodies(first, last) if one.name != ego.name]
    seen = is_visible(*eye_of(ego, own, case.thresholds), person.x[there], person.y[there], first, others)
    return not seen.all()


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count conflicts with hidden pedestrians."""
    return {"n_hidden_before_conflict": int(np.nansum(columns["hidden_before_conflict"]))}
