"""What the ego does while its avoidance problem has no solution: the declared fallback."""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.standing import HOLDING_GENTLY, STANDING
from controllers.interface import Perception
from controllers.velocity_obstacle.paper.kept_option import Kept, tracked

COMFORTABLE = 3.0
"""Deceleration with which the fallback brakes where that is enough [m/s^2]."""
STOPPED_BEFORE = 1.0
"""Distance before a pedestrian at which the fallback stops [m]."""


def fallback(perception: Perception, kept: Kept, times: FloatArray) -> FloatArray:
    """Return accelerations that stop before pedestrians who are not avoided, comfortably if possible [m/s^2].

    The ego does not brake for people beside its body whom it does not touch.
    """
    ego, people, body = perception.ego, perception.pedestrians, perception.ego.body
    if ego.speed < STANDING:
        return np.full(len(times), HOLDING_GENTLY)
    met = np.array([name in kept.option.threats for name in people.names], dtype=bool)
    ahead = met & (people.along > body.front)
    beside = np.abs(people.across - ego.across) < 0.5 * body.width + people.radius
    touched = met & ~ahead & beside & (people.along > -body.rear_overhang)
    if not (ahead | touched).any():
        return tracked(ego, kept, times)
    room = float(people.along[ahead].min(initial=math.inf)) - body.front - STOPPED_BEFORE
    needed = math.inf if touched.any() else ego.speed**2 / (2.0 * max(room, 0.1))
    return np.full(len(times), -min(max(needed, COMFORTABLE), ego.drive.max_deceleration))
