"""Bounds on the position from what is ahead; see ``mpc.speed_tasks``."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray

BODY_GAP = 1.0
"""Least distance to a rear bumper ahead; the time gap is on top of the gap at a standstill [m]."""
BEFORE_LINE = 0.5
"""The front bumper comes to rest so far before a line [m]."""
OPENING = 4.0
"""Time constant with which a time gap that is short already is opened [s]."""


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
    """Return the largest position, the one to be able to stop before, and the one to keep a time gap to.

    Parameters
    ----------
    rear, rest, follow : as in ``Blockade``, shape (N,) [m]
    line : not to be passed by the front bumper; inf for none [m]
    front : from the rear axle to the front bumper [m]
    standstill_gap, gap_now : to the vehicle ahead, at a standstill and at the present speed [m]
    times : horizon, shape (N,) [s]
    """
    # A line that is overrun already asks for a stop here, not for going back.
    upper = np.minimum(rear - BODY_GAP - front, max(line - BEFORE_LINE - front, 0.0))
    stoppable = np.minimum(rest - BODY_GAP - front, max(line - front, 0.0))
    headway = follow - standstill_gap - front
    # A time gap that is short already is opened over some seconds, not by braking hard.
    short = front + gap_now - follow[0]
    if short > 0.0:
        headway = headway + short * np.exp(-times / OPENING)
    return upper, stoppable, headway
