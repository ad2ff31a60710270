"""What the road itself asks of the speed: limits, bends, crossings to be kept clear."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Perception
from controllers.numerics import road_speeds

FloatArray = NDArray[np.float64]

KEEP_CLEAR_BRAKING = 2.5
"""A crossing is kept clear where braking no harder than this suffices [m/s^2]."""


def reference_speed(
    perception: Perception, positions: FloatArray, lateral_acceleration: float, braking: float
) -> FloatArray:
    """Return the highest wanted speed at each position: limits and bends, seen early enough to slow down.

    ``v(s) = min over p >= s of sqrt(v_p^2 + 2 braking (p - s))``

    Parameters
    ----------
    perception
        What the ego is told.
    positions
        Rear-axle positions, shape (N,) [m].
    lateral_acceleration
        Comfortable limit in bends [m/s^2].
    braking
        With which the ego slows down for what it sees [m/s^2].
    """
    wanted: FloatArray = reference_speeds(perception, positions, np.array([[lateral_acceleration, braking]]))[
        0
    ]
    return wanted


def reference_speeds(perception: Perception, positions: FloatArray, demands: FloatArray) -> FloatArray:
    """Return :func:`reference_speed` for rows of lateral acceleration and braking, one row for each."""
    road = perception.road
    return road_speeds.reference_speeds(
        positions, road.curvature, road.curvature_step, road.limit_along, road.limit, demands
    )


def keep_clear_line(
    perception: Perception, times: FloatArray, rest: FloatArray, gap: float, through_for: float | None = None
) -> tuple[float, str]:
    """Return the stop line of a crossing behind which the ego could not stop clear of it; inf for none.

    Parameters
    ----------
    perception
        What the ego is told.
    times, rest
        Where the ego's front may have to stop, by time: the rear bumper of the vehicle ahead should it brake
        hard, or where people are let pass; inf for nowhere [s, m].
    gap
        Kept to that place at a standstill [m].
    through_for
        ``None``: what holds when the ego gets to the stop line decides. Else what holds so long after it
        could have left the crossing: whom it stops for may have gone by then [s].
    """
    ego, body = perception.ego, perception.ego.body
    for crossing in perception.road.crossings:
        on_it = body.front > crossing.entry
        if on_it or crossing.stop_line < body.front - 0.5:
            continue
        room = crossing.stop_line - body.front
        beyond = crossing.exit + body.length + 0.5
        speed = max(ego.speed, 3.0)
        when = max(room, 0.0) / speed if through_for is None else (beyond - body.front) / speed + through_for
        can_stop = ego.speed**2 / (2.0 * KEEP_CLEAR_BRAKING) + 0.3 * ego.speed <= max(room, 0.0) + 0.5
        if can_stop and np.interp(when, times, rest) - gap < beyond:
            return crossing.stop_line, crossing.name
    return float("inf"), ""
