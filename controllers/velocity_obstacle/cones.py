"""Collision cones between the ego and pedestrians, as half-planes on the relative velocity.

``p`` is the pedestrian's position relative to the ego, ``w`` the ego's velocity relative to the
pedestrian. The ego is on a collision course when ``w`` points into the cone that the obstacle, enlarged by
the ego's shape, subtends. A convex solver can use one side of the cone at a time: side +1 keeps ``w`` left
of the left tangent, side −1 right of the right tangent; together the two half-planes cover exactly the
complement of the cone.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray


class Cone(StrEnum):
    """Kind of collision cone: which velocity has to stay outside of it."""

    STEP = "step"
    """The velocity obstacle truncated to one prediction step: positions, not velocities, are kept apart."""
    VO = "vo"
    """The new velocity must leave the cone, Eq. (2)."""
    IVO = "ivo"
    """Interactive: the pedestrian does half of the avoiding; twice the new minus the old velocity leaves the
    cone, Eq. (3)."""
    HYBRID = "hybrid"
    """IVO while the old velocity is already on the wanted side, VO otherwise."""


def tangent(
    px: FloatArray, py: FloatArray, radius: float | FloatArray, side: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the tangent ray from the origin to discs, rotated to ``side`` (+1 left, −1 right).

    ``ray = (p_x c - s p_y r, s p_x r + p_y c)`` with ``c = sqrt(d^2 - r^2)``; its length is ``d^2``. Inside a
    disc ``c`` is 0: the cone is the half-plane away from the disc.

    Parameters
    ----------
    px, py
        Centres of the discs relative to the ego [m].
    radius
        Common radius, ego and pedestrian together [m].
    side
        +1 or −1 for each disc.

    Notes
    -----
    Half angle of Eq. (19) of [VOMPC2019]_ with the square root that its printed form lost.
    """
    c = np.sqrt(np.maximum(px**2 + py**2 - radius**2, 0.0))
    return px * c - side * py * radius, side * px * radius + py * c


def rectangle_tangent(
    px: FloatArray,
    py: FloatArray,
    half_length: float,
    half_width: float,
    radius: float | FloatArray,
    side: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the tangent ray to a rectangle grown by ``radius``, the ego's outline seen from its centre.

    The grown rectangle is the convex hull of discs at its four corners, so its tangent is the outermost of
    theirs. Rays are scaled to unit length. If ``p`` lies inside the grown rectangle, there is no
    tangent and the result is meaningless.
    """
    corners = [(i * half_length, j * half_width) for i in (1, -1) for j in (1, -1)]
    rays = [_unit(*tangent(px + x, py + y, radius, side)) for x, y in corners]
    best_x, best_y = rays[0]
    for x, y in rays[1:]:
        outer = side * (best_x * y - best_y * x) > 0.0
        best_x, best_y = np.where(outer, x, best_x), np.where(outer, y, best_y)
    return best_x, best_y


def _unit(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    norm = np.maximum(np.hypot(x, y), 1e-9)
    return x / norm, y / norm


def clearance(
    ray_x: FloatArray, ray_y: FloatArray, wx: FloatArray, wy: FloatArray, side: FloatArray
) -> FloatArray:
    """Return ``g = s (ray_x w_y - ray_y w_x)``, which is not negative outside the cone."""
    return side * (ray_x * wy - ray_y * wx)
