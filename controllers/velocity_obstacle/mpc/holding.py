"""When a standing ego holds its brake although its plan leads a little farther."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Perception
from controllers.velocity_obstacle.mpc.speed_planning import Chosen

NOWHERE = 0.3
"""It stays where it is if its plan leads less far than this [m]."""
NOT_YET, SOON = 0.05, 1.2
"""It also does so while it lets people pass, if its plan leads less far than the first within the second; a
plan that starts with the brake on leads four times as far [m, s]."""
MOVES_UP = 3.0
"""Or if it would have to stop for them within this distance [m]."""


def holds(perception: Perception, chosen: Chosen, times: FloatArray) -> bool:
    """Return whether a standing ego is to hold its brake for now.

    Pedestrians wait for a vehicle that moves at all, so an ego that creeps up to them has to wait for longer.

    Parameters
    ----------
    perception : what the ego is told
    chosen : its speed plan
    times : times of the plan from now [s]
    """
    position = chosen.plan.position
    if float(position.max()) < NOWHERE:
        return True
    if not chosen.behind:
        return False
    near = chosen.reach.room < MOVES_UP and not _over_a_crossing(perception)
    return near or float(np.interp(SOON, times, position)) < NOT_YET


def _over_a_crossing(perception: Perception) -> bool:
    body = perception.ego.body
    return any(
        crossing.entry < body.front and crossing.exit > -body.rear_overhang
        for crossing in perception.road.crossings
    )
