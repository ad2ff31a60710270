"""Interventions: steps in which SUMO did not follow the plant, and their causes."""

from __future__ import annotations

import math
from enum import StrEnum

from cosim.sumo.placement import Executed, Placement

POSITION_TOLERANCE = 0.02
"""A step is an intervention if SUMO's position is further than this from the plant's [m]."""
SPEED_TOLERANCE = 0.1
"""A step is an intervention if SUMO's speed differs by more than this from the one asked for [m/s]."""


class Cause(StrEnum):
    """Cause of an intervention; ``INTERVENTIONS`` of ``analysis/recording/columns.py`` explains each."""

    TIGHT_BEND = "tight_bend"
    WAY_LOST = "way_lost"
    OFF_LANE = "off_lane"
    HELD = "held"
    POSITION = "position"
    SPEED = "speed"


def cause_of(
    placement: Placement, name: str, front: tuple[float, float], executed: Executed, in_bend: bool
) -> Cause | None:
    """Return why SUMO's state of a driven vehicle differs from the plant's; ``None`` if it does not.

    Parameters
    ----------
    placement : placement that moves the vehicle
    name : name of the vehicle
    front : centre of the plant's front bumper [m]
    executed : where SUMO has the vehicle
    in_bend : whether the vehicle is in a bend tighter than it can turn
    """
    away = math.dist(front, (executed.x, executed.y)) > POSITION_TOLERANCE
    faster = executed.speed - placement.asked_speed(name)
    astray = placement.astray(name)
    nowhere = not executed.lane  # other vehicles do not see it
    if not (astray or away or nowhere or abs(faster) > SPEED_TOLERANCE):
        return None
    off_lane = nowhere or (away and placement.strayed(name) > 0.0)
    if in_bend and (astray or off_lane):
        return Cause.TIGHT_BEND
    if astray:
        return Cause.WAY_LOST
    if off_lane:
        return Cause.OFF_LANE
    if faster < -SPEED_TOLERANCE:
        return Cause.HELD
    return Cause.POSITION if away else Cause.SPEED
