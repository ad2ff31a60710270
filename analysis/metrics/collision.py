"""Contact of the ego's rectangle with the pedestrian's disc while the ego moves.

From the recorded geometry alone, exact between samples; touches of one pair closer than
contact_separation_s are one collision. Where two encounters of a pair hold the same instant, it belongs to
the one with a conflict area, else to the first. A pedestrian who walks into a standing ego (at or below
standing_speed_mps) is listed as contact_standing and is no collision.

Undefined: never; time and side are empty without a collision.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition; exact geometry in analysis/geometry.py"
COLUMNS = (
    column.flag("collision", "contact with the ego moving", required=True),
    column.count("n_collisions", "such contacts, those of one pair within 2 s being one", required=True),
    column.number("t_collision_s", "s", "first contact"),
    column.text("impact_side", "side of the ego that was touched", "front", "rear", "left", "right"),
    column.flag("contact_standing", "the pedestrian touched the standing ego", required=True),
)
RUN_COLUMNS = (
    column.count("n_collisions", "contacts with a moving ego", required=True),
    column.count("n_contacts_standing", "encounters with a contact with the standing ego", required=True),
)


def compute(case: Case) -> Values:
    """Return whether, when and where there was a collision."""
    count = len(case)
    number, standing = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.bool_)
    time = np.full(count, np.nan)
    side: list[str | None] = [None] * count
    for contact in reversed(case.contacts):
        i = contact.encounter
        if contact.standing:
            standing[i] = True
            continue
        number[i] += 1
        time[i] = contact.time
        one = case.encounters[i]
        side[i] = contact.side(0.5 * one.ego.length, 0.5 * one.ego.width)
    return {
        "collision": number > 0,
        "n_collisions": number,
        "t_collision_s": time,
        "impact_side": side,
        "contact_standing": standing,
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count collisions and contacts with a standing ego."""
    return {
        "n_collisions": int(np.sum(columns["n_collisions"])),
        "n_contacts_standing": int(np.sum(columns["contact_standing"])),
    }
