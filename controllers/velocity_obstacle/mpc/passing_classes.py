"""Passing classes: whom the ego lets go first and whom not, and how each class bounds the position.

With n pedestrians sorted by the time at which they enter the ego's path, only n + 1 orders make sense: the
ego lets the first j cross before it (it passes *behind* them) and passes *ahead* of the rest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import STRAIGHT_ON, Conflicts
from controllers.velocity_obstacle.mpc.arithmetic import passing_bounds


def class_name(conflicts: Conflicts, behind: int) -> str:
    """Return whom the ego passes behind and ahead of: ``behind=p1|p2 ahead=p3``; empty without conflicts."""
    if not len(conflicts):
        return ""
    return f"behind={'|'.join(conflicts.names[:behind])} ahead={'|'.join(conflicts.names[behind:])}"


def stops(
    conflicts: Conflicts, behind: int, front: float, margin_along: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where pedestrians let go first are, where the front bumper stops, and until when [m, m, s].

    Parameters
    ----------
    conflicts, behind
        Conflicts sorted by time of entry, and how many pedestrians are let go first.
    front
        Distance from the rear axle to the front bumper [m].
    margin_along
        Free distance to a pedestrian's disc along the path [m].
    """
    c = conflicts
    before = c.along[:behind] - c.radius[:behind] - margin_along
    line = c.stop_line[:behind]
    # Once the bumper is past the stop line, only the pedestrian counts.
    places = np.where(front <= line + 0.3, np.minimum(before, np.maximum(line, front)), before)
    return c.along[:behind], places, c.leave[:behind]


class ClassBounds(NamedTuple):
    """Bounds of each passing class on the rear axle's position, shape (n + 1, N) each.

    Row j is the class in which the ego passes behind the first j pedestrians. Every half-plane of this
    formulation bounds the position alone, so only the tightest one matters at each time: the program does not
    grow with the number of pedestrians, and nothing is lost.
    """

    upper: FloatArray
    """Largest position while a pedestrian let go first has not left; inf where free [m]."""
    lower: FloatArray
    """Least position once a pedestrian the ego passes ahead of enters; −inf where free [m]."""
    freeze: FloatArray
    """As ``upper``, but only while a pedestrian is expected in the band: the ego must still be able to stop
    here should they stop walking [m]."""


def class_bounds(
    conflicts: Conflicts,
    times: FloatArray,
    front: float,
    rear: float,
    margin_along: float,
    speed: FloatArray,
) -> ClassBounds:
    """Return the bounds of all passing classes.

    Parameters
    ----------
    conflicts
        Conflicts sorted by time of entry.
    times
        Horizon, shape (N,) [s].
    front, rear
        Distances from the rear axle to the front bumper and to the rear bumper (positive) [m].
    margin_along
        Free distance to a pedestrian's disc along the path [m].
    speed
        Expected speed at each time, which carries a bound from the instant it holds to the next grid time,
        shape (N,) [m/s].
    """
    c = conflicts
    reach = c.radius + margin_along
    if c.forecast is None:
        bounds = passing_bounds.straight_class_bounds(
            c.enter,
            c.leave,
            c.stop_line,
            c.along,
            c.along_speed,
            STRAIGHT_ON,
            reach,
            times,
            speed,
            front,
            rear,
        )
    else:
        there = c.forecast.at(times)
        kept = reach[:, None] + there.reach
        bounds = passing_bounds.class_bounds(
            c.enter, c.leave, c.stop_line, there.along, kept, times, speed, front, rear
        )
    return ClassBounds(*bounds)
