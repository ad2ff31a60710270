"""Bounds on the position from vehicles and lines ahead; see ``mpc.speed_tasks``."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray

BODY_GAP = 1.0
"""Least distance to a rear bumper ahead; the time gap comes on top of the gap at a standstill [m]."""
BEFORE_LINE = 0.5
"""Distance before a line at which the front bumper comes to rest [m]."""
OPENING = 4.0
"""Time constant with which a time gap that is already too short is opened [s]."""


def position_bounds(
    rear: FloatArray,
    rest: FloatArray,
    follow: FloatArray,
    line: float,
    front: float,
    standstill_gap: float,
    gap_now: float,
    times: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the largest position, the one the ego must be able to stop before, and the one for the time gap.

    Parameters
    ----------
    rear, rest, follow : as in ``Blockade``, shape (N,) [m]
    line : place that the front bumper must not pass; inf for none [m]
    front : distance from the rear axle to the front bumper [m]
    standstill_gap, gap_now : wanted gap to the vehicle ahead, at a standstill and at the present speed [m]
    times : horizon, shape (N,) [s]
    """
    # Past a line that has been overrun already, the ego stops where it is and does not go back.
    upper = np.minimum(rear - BODY_GAP - front, max(line - BEFORE_LINE - front, 0.0))
    stoppable = np.minimum(rest - BODY_GAP - front, max(line - front, 0.0))
    headway = follow - standstill_gap - front
    # A time gap that is already too short is opened over some seconds, not by braking hard.
    short = front + gap_now - follow[0]
    if short > 0.0:
        headway = headway + short * np.exp(-times / OPENING)
    return upper, stoppable, headway
