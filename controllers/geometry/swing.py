"""How far the front of a vehicle swings out of a bend that its rear axle follows."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Body

STRAIGHT = 1e-3
"""Below this curvature, a road counts as straight [1/m]."""


def swung_out(body: Body, curvature: FloatArray) -> FloatArray:
    """Return how far the outer front corner swings out beyond the outer side, shape of ``curvature`` [m].

    Parameters
    ----------
    body : body of the vehicle
    curvature : curvature of its rear axle's way, left or right [1/m]

    >>> swung_out(Body(), np.array([0.0, -1.0 / 6.0])).round(2).tolist()
    [0.0, 0.86]
    """
    bent = np.abs(curvature)
    radius = 1.0 / np.maximum(bent, STRAIGHT) + 0.5 * body.width
    return np.where(bent > STRAIGHT, np.hypot(radius, body.front) - radius, 0.0)


def farthest_out(body: Body, curvature: FloatArray) -> float:
    """Return how far the front swings out in the tightest of the bends [m]; 0 without any curvature."""
    return float(swung_out(body, curvature).max(initial=0.0))
