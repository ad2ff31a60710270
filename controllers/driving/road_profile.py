"""What the road itself asks of the speed: limits, bends, crossings to be kept clear."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Perception

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
    return reference_speeds(perception, positions, ((lateral_acceleration, braking),))[0]


def reference_speeds(
    perception: Perception, positions: FloatArray, demands: Sequence[tuple[float, float]]
) -> list[FloatArray]:
    """Return :func:`reference_speed` for several pairs of lateral acceleration and braking [m/s^2]."""
    road = perception.road
    along = np.arange(len(road.curvature)) * road.curvature_step
    bend = np.maximum(np.abs(road.curvature), 1e-4)
    if len(road.limit) and road.limit_along[0] <= 0.0:
        # A limit holds everywhere: of the road's many points only bends slower than that matter.
        slow = bend * road.limit.max() ** 2 > min(lateral for lateral, _ in demands)
        along, bend = along[slow], bend[slow]
    points = np.concatenate((along, road.limit_along))
    if len(points) == 0:
        return [np.full(len(positions), np.inf) for _ in demands]
    ahead = points - positions[:, None]
    # A bend counts until the instant before has left it behind, or one between two instants would be
    # missed; a limit counts until the next one begins.
    since = np.concatenate(([0.0], positions[:-1]))
    gone = points < np.minimum(since, positions)[:, None]
    gone[:, len(along) :] = False
    if len(road.limit_along) > 1:
        gone[:, len(along) : -1] = road.limit_along[1:] <= positions[:, None]
    distance = np.where(gone, np.inf, np.maximum(ahead, 0.0))
    return [
        np.sqrt(
            np.minimum(
                (np.concatenate((lateral / bend, road.limit**2)) + 2.0 * braking * distance).min(axis=1), 1e4
            )
        )
        for lateral, braking in demands
    ]


def keep_clear_line(
    perception: Perception, times: FloatArray, leader_rest: FloatArray, gap: float
) -> tuple[float, str]:
    """Return the stop line of a crossing behind which the ego could not stop clear of it; inf for none.

    Parameters
    ----------
    perception
        What the ego is told.
    times, leader_rest
        Where the rear bumper of the vehicle ahead could come to rest, by time; inf for none [s, m].
    gap
        Kept to it at a standstill [m].
    """
    ego, body = perception.ego, perception.ego.body
    for crossing in perception.road.crossings:
        on_it = body.front > crossing.entry
        if on_it or crossing.stop_line < body.front - 0.5:
            continue
        room = crossing.stop_line - body.front
        arrival = max(room, 0.0) / max(ego.speed, 3.0)
        beyond = crossing.exit + body.length + 0.5
        can_stop = ego.speed**2 / (2.0 * KEEP_CLEAR_BRAKING) + 0.3 * ego.speed <= max(room, 0.0) + 0.5
        if can_stop and np.interp(arrival, times, leader_rest) - gap < beyond:
            return crossing.stop_line, crossing.name
    return float("inf"), ""
