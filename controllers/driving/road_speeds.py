"""How fast the road itself lets the ego drive: speed limits and bends, here and ahead."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Perception

STRAIGHT = 1e-4
"""Below this curvature, the road counts as straight [1/m]."""
HIGHEST = 100.0
"""Highest speed that is ever returned [m/s]."""


def reference_speed(
    perception: Perception, positions: FloatArray, lateral_acceleration: float, braking: float
) -> FloatArray:
    """Return the highest speed at each position that allows slowing down for limits and bends ahead [m/s].

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
        Deceleration with which the ego slows down for limits and bends ahead [m/s^2].
    """
    demands = np.array([[lateral_acceleration, braking]])
    wanted: FloatArray = reference_speeds(perception, positions, demands)[0]
    return wanted


def reference_speeds(perception: Perception, positions: FloatArray, demands: FloatArray) -> FloatArray:
    """Return :func:`reference_speed` for several demands, one row for each, shape (demands, N) [m/s].

    Parameters
    ----------
    perception, positions
        As for :func:`reference_speed`.
    demands
        Rows of lateral acceleration in bends and deceleration before them [m/s^2].
    """
    road = perception.road
    curvature, limit_along, limit = road.curvature, road.limit_along, road.limit
    along = np.arange(len(curvature)) * road.curvature_step
    bend = np.maximum(np.abs(curvature), STRAIGHT)
    if len(limit) > 0 and limit_along[0] <= 0.0:
        # A limit holds everywhere: of the road's many points, only bends slower than the limit matter.
        slow = (bend * limit.max() ** 2 > demands[:, 0].min()).nonzero()[0]
        along, bend = along[slow], bend[slow]
    points = np.concatenate((along, limit_along))
    if len(points) == 0:
        return np.full((len(demands), len(positions)), np.inf)
    # A bend counts until the previous instant has left it behind; otherwise a bend between two instants
    # would be missed. A limit counts until the next one begins.
    since = np.zeros(len(positions))
    since[1:] = positions[:-1]
    since = np.minimum(since, positions)
    ends = np.full(len(limit_along), np.inf)
    ends[:-1] = limit_along[1:]
    left = np.concatenate((along, ends))
    distance = np.maximum(points - positions.reshape(-1, 1), 0.0)
    gone = left < since.reshape(-1, 1)
    gone[:, len(along) :] = ends <= positions.reshape(-1, 1)
    distance = np.where(gone, np.inf, distance)
    squares = np.empty((len(demands), 1, len(points)))
    squares[:, 0, : len(along)] = demands[:, :1] / bend
    squares[:, 0, len(along) :] = limit**2
    squares = squares + (2.0 * demands[:, 1]).reshape(-1, 1, 1) * distance
    return np.asarray(np.sqrt(np.minimum(np.minimum.reduce(squares, axis=2), HIGHEST**2)))
