"""Wheels that are turned wrongly have to be turned back before the ego drives off briskly.

Who stood and steered round somebody, or was taken over with turned wheels, needs up to two seconds to turn
them. At the acceleration of a free road the ego would be in another lane by then.
"""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState

AWRY = 0.05
"""So much the ego may point elsewhere when its wheels have turned [rad]."""
NEARLY = 0.95
"""Wheels that are planned to turn with this share of their rate turn as fast as they can [-]."""
SETTLING, BRAKING = 0.5, 1.5
"""The ego slows down within such a time, and with no more than this [s, m/s^2]."""


def held_back(ego: EgoState, times: FloatArray, angles: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Return accelerations with which the ego is slow enough until its wheels have turned [m/s^2].

    While they turn, the curvature goes steadily from its wrong value to the wanted one, so that half the
    difference counts for where the ego points afterwards.

    Parameters
    ----------
    ego : with its present steering
    times, angles : steering as planned, shape (N,) each [s, rad]
    acceleration : what is wanted, shape (n,) [m/s^2]
    """
    turning = _turning(ego, times, angles)
    if turning == 0:
        return acceleration
    off = abs(math.tan(angles[turning - 1]) - math.tan(ego.steering)) / ego.body.wheelbase
    slow_enough = AWRY / max(0.5 * off * float(times[turning - 1]), 1e-6)
    return np.minimum(acceleration, max((slow_enough - ego.speed) / SETTLING, -BRAKING))


def _turning(ego: EgoState, times: FloatArray, angles: FloatArray) -> int:
    """Return for how many of the planned instants from now the wheels turn one way as fast as they can."""
    rates = np.diff(angles, prepend=ego.steering) / np.diff(times, prepend=0.0)
    fast = rates * np.sign(rates[0]) >= NEARLY * ego.drive.max_steering_rate
    return len(fast) if fast.all() else int(np.argmin(fast))
