"""Whether the competent and careful driver of UN R157 would have prevented the contact.

With a contact, that driver is put at the wheel and the recording is replayed
(analysis/encounters/careful_driver.py): the driver follows the ego's own path at the recorded speed, at most
the limit, until r157_reaction_s after they could see a risk: that the pedestrian was, or within
r157_foresight_s would be, in the way or within r157_wander_m of it. Of several spells of risk, the last
before the contact counts, from at most 30 s before it; a spell ends after r157_foresight_s without risk. Then
the driver brakes, with r157_deceleration_mps2 within r157_ramp_s, until the ego stands. The pedestrian moves
as recorded. 1 where the replayed ego does not touch the pedestrian while it moves, until r157_after_s after
the recorded contact, else 0. That holds for turning egos and for people who stand in the lane, too. What
counts is what could be seen: vehicles hide people, the ego's own sensors do not matter. The first collision
counts, without one the first contact with the standing ego.

Without a contact nothing is replayed. Then it says whether the driver could have stopped: 1 where the way to
the conflict area, at the instant the pedestrian steps on the crossing (away from crossings: at the
encounter's beginning), is at least that driver's stopping distance.

For a driver who also takes 0.4 s to evaluate the risk, set r157_reaction_s to 1.15.

Undefined: never with a contact. Without one, empty where there is no conflict area, or where the ego was in
it before the pedestrian could be seen to enter.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import entries, stopping_distance
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "[R157], reference driver, after a transcription; the replay is our own definition"
COLUMNS = (
    column.flag(
        "preventable_r157",
        "a careful driver would have prevented the contact, without one: could have stopped; "
        "empty where undefined",
    ),
)
RUN_COLUMNS = (
    column.count(
        "n_collisions_preventable", "those that a careful driver prevents", required=True, worse="higher"
    ),
)


def compute(case: Case) -> Values:
    """Return 1, 0, or nan where it is undefined."""
    entry = entries(case)
    limits = case.thresholds
    needed = stopping_distance(
        entry.ego_speed, limits.r157_reaction_s, limits.r157_deceleration_mps2, limits.r157_ramp_s
    )
    values = np.where(np.isnan(entry.time), np.nan, entry.distance >= needed)
    for i, contact in enumerate(case.first_contact()):
        if contact is not None:
            values[i] = case.replays[contact].prevented
    return {"preventable_r157": values}


def collect_encounters(case: Case) -> Values:
    """Return for every collision whether the careful driver prevents it."""
    return {"prevented": [case.replays[contact].prevented for contact in case.collisions()]}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the collisions that the careful driver prevents."""
    return {"n_collisions_preventable": sum(columns["prevented"])}
