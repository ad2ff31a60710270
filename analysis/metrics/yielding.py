"""Whether an ego that could have yielded did.

Pedestrians arrive when they first stand waiting for the crossing or step on it. The ego could
yield (yieldable) if it was then further from the crossing than v t + v^2 / (2 a), with
yield_reaction_s and yield_deceleration_mps2, and at its speed would have reached the crossing before
they left it. It yielded if they were on the crossing before the ego was, came to the ground that both used
first, and were not hit.

Undefined: empty where it could not have yielded, where signals decide, where it does not pass the
crossing, or where the person does not come to it. yield_rate is yields over yieldable encounters.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.crossing_walks import after_earlier_walk
from analysis.encounters.finding import Encounter
from analysis.encounters.moments import crossing_stay, phase_samples, ride_of
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "lower"
SOURCE = "[NCHRP562]; the reaction time and deceleration are assumed"
COLUMNS = (column.flag("yielded", "the ego let the pedestrian go first; empty where it could not have"),)
RUN_COLUMNS = (
    column.count("yields", "egos that let a pedestrian go first", required=True),
    column.count(
        "yieldable", "encounters in which the ego could have yielded", required=True, worse="neither"
    ),
    column.share("yield_rate", "yields over yieldable"),
)


def compute(case: Case) -> Values:
    """Return 1, 0, or nan where the ego could not have yielded."""
    yielded = np.array([_yielded(case, one) for one in case.encounters], dtype=np.float64)
    hit = np.array([contact is not None for contact in case.first_collision()], dtype=np.bool_)
    yielded[hit & (yielded == 1.0)] = 0.0
    return {"yielded": yielded}


def _yielded(case: Case, one: Encounter) -> float:
    if one.crossing_kind == "signal" or one.traversal is None or one.traversal.track is not one.ego:
        return np.nan
    stay = crossing_stay(case, one)
    standing = one.person.speed < case.thresholds.pedestrian_standing_speed_mps
    waits = phase_samples(case, one, "waiting") & standing
    waits[: max(one.first - one.person.first, 0)] = False
    end = one.last - one.person.first if stay is None else stay[0]
    waits[: after_earlier_walk(phase_samples(case, one, "crossing"), end)] = False
    present = np.flatnonzero(waits if stay is None else waits[: stay[0]])
    if len(present):
        arrival = int(present[0])
    elif stay is not None:
        arrival = stay[0]
    else:
        return np.nan
    time = case.grid.time
    arrives = float(time[one.person.first + arrival])
    ego_enters = one.traversal.visit.enter
    if not time[one.ego.first] <= arrives < ego_enters:
        return np.nan
    ride = ride_of(case, one.ego)
    speed, way = ride.speed_at(arrives), ride.way(arrives, ego_enters)
    limits = case.thresholds
    needed = speed * limits.yield_reaction_s + speed**2 / (2.0 * limits.yield_deceleration_mps2)
    leaves = np.inf if stay is None else float(time[one.person.first + stay[1]])
    if way <= needed or (speed > 0.0 and way / speed >= leaves - arrives):
        return np.nan
    before = stay is not None and time[one.person.first + stay[0]] < ego_enters
    return float(before and (one.area is None or one.area.person.enter < one.area.ego.enter))


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count yields and chances to yield."""
    yielded = np.asarray(columns["yielded"])
    known = yielded[np.isfinite(yielded)]
    return {
        "yields": int(known.sum()),
        "yieldable": len(known),
        "yield_rate": known.mean() if len(known) else None,
    }
