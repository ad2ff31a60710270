"""Wheels that are turned wrongly have to be turned back before the ego drives off briskly.

Who stood and steered round somebody, or was taken over with turned wheels, needs up to two seconds to turn
them. At the acceleration of a free road the ego would be in another lane by then.
"""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping
from controllers.interface import EgoState, Perception

AWRY = 0.05
"""So much the ego may point elsewhere when its wheels have turned [rad]."""
SLOW = 3.0
"""A faster ego has its wheels where the road wants them [m/s]."""
SETTLING, BRAKING = 0.5, 1.5
"""The ego slows down within such a time, and with no more than this [s, m/s^2]."""


def held_back(perception: Perception, acceleration: FloatArray) -> FloatArray:
    """Return accelerations with which the ego is slow enough until its wheels have turned [m/s^2].

    Parameters
    ----------
    perception : what the ego is told
    acceleration : what is wanted, shape (n,) [m/s^2]
    """
    ego = perception.ego
    if ego.speed > SLOW:
        return acceleration
    wanted = float(lane_keeping.steering(perception, ego.across, np.zeros(1))[0])
    most = max((_slow_enough(ego, wanted) - ego.speed) / SETTLING, -BRAKING)
    return np.minimum(acceleration, most)


def _slow_enough(ego: EgoState, wanted: float) -> float:
    """Return the speed at which the wheels are at an angle before the ego points elsewhere [m/s].

    The curvature goes steadily from its wrong value to the wanted one: half the difference counts.
    """
    time = abs(wanted - ego.steering) / ego.drive.max_steering_rate
    off = abs(math.tan(wanted) - math.tan(ego.steering)) / ego.body.wheelbase
    return AWRY / max(0.5 * off * time, 1e-6)
