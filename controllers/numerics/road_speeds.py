"""How fast bends and limits ahead let the ego drive; see :mod:`controllers.driving.road_speeds`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

STRAIGHT = 1e-4
"""A curvature below this is none [1/m]."""
HIGHEST = 100.0
"""No speed is asked for beyond this [m/s]."""


def reference_speeds(
    positions: FloatArray,
    curvature: FloatArray,
    curvature_step: float,
    limit_along: FloatArray,
    limit: FloatArray,
    demands: FloatArray,
) -> FloatArray:
    """Return the highest wanted speed at each position, for each demand, shape (demands, N).

    Parameters
    ----------
    positions : of the rear axle, shape (N,) [m]
    curvature, curvature_step, limit_along, limit : as in ``RoadAhead``
    demands : rows of what is allowed in bends, and slowed down with [m/s^2]
    """
    along = np.arange(len(curvature)) * curvature_step
    bend = np.maximum(np.abs(curvature), STRAIGHT)
    if len(limit) > 0 and limit_along[0] <= 0.0:
        # A limit holds everywhere: of the road's many points only bends slower than that matter.
        slow = np.flatnonzero(bend * limit.max() ** 2 > demands[:, 0].min())
        along, bend = along[slow], bend[slow]
    points = np.concatenate((along, limit_along))
    speeds = np.full((len(demands), len(positions)), np.inf)
    if len(points) == 0:
        return speeds
    # A bend counts until the instant before has left it behind, or one between two instants would be
    # missed; a limit counts until the next one begins.
    since = np.minimum(np.append(0.0, positions[:-1]), positions)
    ends = np.append(limit_along[1:], np.inf)[: len(limit_along)]
    left = np.concatenate((along, ends))
    distance = np.maximum(points - positions.reshape(-1, 1), 0.0)
    gone = left < since.reshape(-1, 1)
    gone[:, len(along) :] = ends <= positions.reshape(-1, 1)
    distance = np.where(gone, np.inf, distance)
    for i in range(len(demands)):
        lateral, braking = demands[i]
        squares = np.concatenate((lateral / bend, limit**2))
        speeds[i] = np.sqrt(np.minimum((squares + 2.0 * braking * distance).min(axis=1), HIGHEST**2))
    return speeds
