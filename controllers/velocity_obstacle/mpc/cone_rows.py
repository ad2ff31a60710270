"""Distance of the ego's motion from a pedestrian's collision cone, with its gradient for a QP.

The velocity obstacle of an outline, truncated in time: a relative velocity ``u`` is harmless when it lies
beyond the cone's tangent on the wanted side, or when it does not close the gap within the truncation time.
Both are half-planes; the one that the nominal motion satisfies better is kept, so each row is linear and
an inner approximation of what is allowed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.cones import Cone, clearance, rectangle_tangent

SLOWEST, LONGEST = 0.3, 5.0
"""Bounds of the time that converts a distance between velocities into metres [s]."""
DIFFERENCE = 1e-4
"""Step of the central differences [m, rad]."""


@dataclass(frozen=True, slots=True)
class Outline:
    """Shape that the cone encloses: a rectangle about the body's centre, or a disc if it has no extent."""

    half_length: float
    half_width: float
    centre: float
    """Distance of the body's centre ahead of the rear axle [m]."""
    radius: float | None
    """Radius of ego and pedestrian together; ``None``: the pedestrian's own radius [m]."""


@dataclass(frozen=True, slots=True)
class ConeSettings:
    """Kind of cone, the shape that it encloses, and how far it looks ahead."""

    kind: Cone
    outline: Outline
    truncation: float
    """Collisions later than this do not count; inf for the paper's infinite cone [s]."""


@dataclass(frozen=True, slots=True)
class Walkers:
    """Predicted pedestrians, arrays of shape (m, N) over the horizon; ``radius`` and ``side`` (m,)."""

    x: FloatArray
    y: FloatArray
    vx: FloatArray
    vy: FloatArray
    radius: FloatArray
    side: FloatArray
    """+1: the relative velocity stays left of the left tangent; −1: right of the right one; 0: either."""
    reach: FloatArray | float = 0.0
    """Growth of the outline because pedestrians may be elsewhere than predicted, shape (m, N) [m]."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of the rear axle, shape (N,) each, with its heading and speed at the start."""

    position: FloatArray
    across: FloatArray
    heading: FloatArray
    speed: FloatArray
    start_heading: float
    start_speed: float

    def velocity(self) -> tuple[FloatArray, FloatArray]:
        """Return the velocity at each time."""
        return self.speed * np.cos(self.heading), self.speed * np.sin(self.heading)

    def earlier(self) -> tuple[FloatArray, FloatArray]:
        """Return speed and heading one step before each time."""
        return (
            np.concatenate(([self.start_speed], self.speed[:-1])),
            np.concatenate(([self.start_heading], self.heading[:-1])),
        )


@dataclass(frozen=True, slots=True)
class ConeRows:
    """``value + gradient . change >= 0`` for each pedestrian and time, in metres; shape (m, N) each.

    ``value`` is roughly how far outside the outline the nominal motion stays at its nearest approach; it is
    negative inside. ``speed_before`` and ``heading_before`` belong to the state one step earlier.
    """

    value: FloatArray
    position: FloatArray
    across: FloatArray
    heading: FloatArray
    speed: FloatArray
    heading_before: FloatArray
    speed_before: FloatArray


def rows(settings: ConeSettings, walkers: Walkers, nominal: Motion) -> ConeRows:
    """Return the half-planes about a nominal motion.

    Parameters
    ----------
    settings
        See :class:`ConeSettings`.
    walkers
        Where the pedestrians will be, and on which side they are passed.
    nominal
        Motion about which the rows are linearised.

    Notes
    -----
    The cone at a time uses the positions and the velocities of that time, Eqs. (16) and (17) of
    [VOMPC2019]_ read with the full angle on both sides. The velocity "before" of the interactive and the
    hybrid cone is that of the preceding time of the horizon; for the first time, it is the present velocity.
    """
    outline = settings.outline
    cos, sin = np.cos(nominal.heading), np.sin(nominal.heading)
    px = walkers.x - nominal.position - outline.centre * cos
    py = walkers.y - nominal.across - outline.centre * sin
    radius = np.broadcast_to(
        walkers.radius[:, None] if outline.radius is None else np.float64(outline.radius), px.shape
    )
    radius = radius + walkers.reach
    speed_before, heading_before = nominal.earlier()
    vx, vy = nominal.velocity()
    old_x, old_y = speed_before * np.cos(heading_before), speed_before * np.sin(heading_before)
    side = np.broadcast_to(walkers.side[:, None], px.shape)
    turn = px * (vy - walkers.vy) - py * (vx - walkers.vx)
    side = np.where(side == 0.0, np.where(turn >= 0.0, 1.0, -1.0), side)
    share = _interaction(settings.kind, px, py, old_x - walkers.vx, old_y - walkers.vy, side)
    ux = (1.0 + share) * vx - share * old_x - walkers.vx
    uy = (1.0 + share) * vy - share * old_y - walkers.vy

    heading = np.broadcast_to(nominal.heading, px.shape)
    leg = _leg(outline, px, py, heading, ux, uy, radius, side)
    cap, distance = _cap(outline, px, py, heading, ux, uy, radius, settings.truncation)
    by_cap = (distance < radius) | (cap > leg)

    def value(x: FloatArray, y: FloatArray, angle: FloatArray) -> FloatArray:
        beyond = _leg(outline, x, y, angle, ux, uy, radius, side)
        return np.where(by_cap, _cap(outline, x, y, angle, ux, uy, radius, settings.truncation)[0], beyond)

    h = DIFFERENCE
    by_x = (value(px + h, py, heading) - value(px - h, py, heading)) / (2.0 * h)
    by_y = (value(px, py + h, heading) - value(px, py - h, heading)) / (2.0 * h)
    by_turn = (value(px, py, heading + h) - value(px, py, heading - h)) / (2.0 * h)
    by_ux, by_uy = _velocity_gradient(outline, px, py, heading, radius, side, by_cap)

    # The body's centre swings round the rear axle; p is relative to that centre.
    by_turn = by_turn + outline.centre * (by_x * sin - by_y * cos)
    before_cos, before_sin = np.cos(heading_before), np.sin(heading_before)
    seconds = np.clip(np.hypot(px, py) / np.maximum(np.hypot(ux, uy), 1e-6), SLOWEST, LONGEST)
    new, old = (1.0 + share) * seconds, -share * seconds
    return ConeRows(
        value=np.where(by_cap, cap, leg) * seconds,
        position=-by_x * seconds,
        across=-by_y * seconds,
        heading=by_turn * seconds + new * nominal.speed * (by_uy * cos - by_ux * sin),
        speed=new * (by_ux * cos + by_uy * sin),
        heading_before=old * speed_before * (by_uy * before_cos - by_ux * before_sin),
        speed_before=old * (by_ux * before_cos + by_uy * before_sin),
    )


def _interaction(
    kind: Cone, px: FloatArray, py: FloatArray, old_x: FloatArray, old_y: FloatArray, side: FloatArray
) -> FloatArray:
    """Return 1 for the interactive cone, ``2 V_new - V_old - V_O``, and 0 for the plain one."""
    if kind is Cone.IVO:
        return np.ones(px.shape)
    if kind is Cone.HYBRID:
        return np.where(side * (px * old_y - py * old_x) > 0.0, 1.0, 0.0)
    return np.zeros(px.shape)


def _turned(x: FloatArray, y: FloatArray, heading: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return vectors in the frame of a body with that heading."""
    cos, sin = np.cos(heading), np.sin(heading)
    return cos * x + sin * y, cos * y - sin * x


def _leg(
    outline: Outline,
    px: FloatArray,
    py: FloatArray,
    heading: FloatArray,
    ux: FloatArray,
    uy: FloatArray,
    radius: FloatArray,
    side: FloatArray,
) -> FloatArray:
    """Return the distance of ``u`` from the tangent's half-plane, positive outside the cone [m/s]."""
    x, y = _turned(px, py, heading)
    ray_x, ray_y = rectangle_tangent(x, y, outline.half_length, outline.half_width, radius, side)
    return clearance(ray_x, ray_y, *_turned(ux, uy, heading), side)


def _nearest(
    outline: Outline, px: FloatArray, py: FloatArray, heading: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the distance from the outline to a point and the direction to it, in the body's frame."""
    x, y = _turned(px, py, heading)
    gap_x = x - np.clip(x, -outline.half_length, outline.half_length)
    gap_y = y - np.clip(y, -outline.half_width, outline.half_width)
    distance = np.hypot(gap_x, gap_y)
    touching = distance < 1e-9
    gap_x, gap_y = np.where(touching, x, gap_x), np.where(touching, y, gap_y)
    norm = np.maximum(np.hypot(gap_x, gap_y), 1e-9)
    return distance, gap_x / norm, gap_y / norm


def _cap(
    outline: Outline,
    px: FloatArray,
    py: FloatArray,
    heading: FloatArray,
    ux: FloatArray,
    uy: FloatArray,
    radius: FloatArray,
    truncation: float,
) -> tuple[FloatArray, FloatArray]:
    """Return by how much ``u`` is too slow to close the gap before truncation [m/s], and the distance [m]."""
    distance, normal_x, normal_y = _nearest(outline, px, py, heading)
    x, y = _turned(ux, uy, heading)
    gap = distance - radius
    # A gap that is negative already is opened at a finite speed, however short the truncation.
    allowed = gap / np.where(gap < 0.0, max(truncation, 1.0), truncation)
    return allowed - x * normal_x - y * normal_y, distance


def _velocity_gradient(
    outline: Outline,
    px: FloatArray,
    py: FloatArray,
    heading: FloatArray,
    radius: FloatArray,
    side: FloatArray,
    by_cap: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray]:
    """Return the gradient with respect to ``u``, of which both half-planes are affine functions."""
    x, y = _turned(px, py, heading)
    ray_x, ray_y = rectangle_tangent(x, y, outline.half_length, outline.half_width, radius, side)
    _, normal_x, normal_y = _nearest(outline, px, py, heading)
    return _turned(
        np.where(by_cap, -normal_x, -side * ray_y), np.where(by_cap, -normal_y, side * ray_x), -heading
    )
