"""Wheels that are turned wrongly have to be turned back before the ego drives off briskly.

An ego that stood while steering round a pedestrian, or was taken over with turned wheels, needs up to two
seconds to turn them back. With the acceleration of a free road it would be in another lane by then.
"""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState

AWRY = 0.05
"""Allowed error of the ego's heading by the time its wheels have turned [rad]."""
NEARLY = 0.95
"""Wheels that turn with this share of their greatest rate or more count as turning at full rate [-]."""
SETTLING, BRAKING = 0.5, 1.5
"""Time within which the ego slows down, and greatest deceleration for it [s, m/s^2]."""


def held_back(ego: EgoState, times: FloatArray, angles: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Return accelerations that keep the ego slow enough until its wheels have turned [m/s^2].

    While the wheels turn, the curvature changes steadily from its wrong value to the wanted one, so half the
    difference counts for the heading error afterwards.

    Parameters
    ----------
    ego : gives the present steering
    times, angles : planned steering, shape (N,) each [s, rad]
    acceleration : wanted accelerations, shape (n,) [m/s^2]
    """
    turning = _turning(ego, times, angles)
    if turning == 0:
        return acceleration
    off = abs(math.tan(angles[turning - 1]) - math.tan(ego.steering)) / ego.body.wheelbase
    slow_enough = AWRY / max(0.5 * off * float(times[turning - 1]), 1e-6)
    return np.minimum(acceleration, max((slow_enough - ego.speed) / SETTLING, -BRAKING))


def _turning(ego: EgoState, times: FloatArray, angles: FloatArray) -> int:
    """Return for how many planned instants from now on the wheels turn one way as fast as they can."""
    rates = np.diff(angles, prepend=ego.steering) / np.diff(times, prepend=0.0)
    fast = rates * np.sign(rates[0]) >= NEARLY * ego.drive.max_steering_rate
    return len(fast) if fast.all() else int(np.argmin(fast))
