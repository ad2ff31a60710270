"""How far motions in steps stay outside the collision cones of pedestrians, with exact derivatives.

The margin of a relative velocity ``w`` on side s is its distance from the tangent's half-plane, ``s (b_x w_y
- b_y w_x)`` with the unit tangent ``b = (cos B, sin B)``, ``B = alpha + s asin(r / d)``; see
:mod:`controllers.velocity_obstacle.cones`, whose ``clearance`` is the same times d squared. Within the
disc there is no tangent; there the margin is by how much the straight line along ``w`` misses the pedestrian
on that side, less the radius: ``s (p_x w_y - p_y w_x) / |w| - r``, never more than ``d - r``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.paper.euler_bicycle import ACROSS, ALONG, HEADING, SPEED

TOUCHING = 1e-3
"""Below this distance to the disc, the turning of the tangent is not tracked any further [m]."""


@dataclass(frozen=True, slots=True)
class People:
    """Predicted pedestrians, arrays of shape (m, n) over the steps."""

    along: FloatArray
    """Positions after each step [m]."""
    across: FloatArray
    along_speed: FloatArray
    """Speeds before each step [m/s]."""
    across_speed: FloatArray
    side: FloatArray
    """+1: passed on the left of the line of sight; −1: right of it; 0: either, step by step; shape (m,)."""
    radius: FloatArray
    """Radius of vehicle and pedestrian together, plus the uncertainty of the position, shape (m, n) [m]."""

    def __len__(self) -> int:
        return len(self.side)

    def only(self, chosen: NDArray[np.int64]) -> People:
        """Return the pedestrians with the given indices."""
        return People(
            self.along[chosen],
            self.across[chosen],
            self.along_speed[chosen],
            self.across_speed[chosen],
            self.side[chosen],
            self.radius[chosen],
        )


def nobody(steps: int) -> People:
    """Return no pedestrians."""
    none = np.zeros((0, steps))
    return People(none, none, none, none, np.zeros(0), none)


@dataclass(frozen=True, slots=True)
class ConeGradients:
    """Derivatives of the margins by the states after and before a step, shape (m, n) each."""

    along: FloatArray
    across: FloatArray
    heading: FloatArray
    speed: FloatArray
    heading_before: FloatArray
    speed_before: FloatArray


def cone_margins(kind: Cone, people: People, states: FloatArray, reference_point: float = 0.0) -> FloatArray:
    """Return the margins after each step, shape (..., m n) [m/s, or m within a disc].

    Parameters
    ----------
    kind
        ``vo``, ``ivo`` or ``hybrid``.
    people
        See :class:`People`.
    states
        States of motions, shape (..., 5, n + 1).
    reference_point
        Distance from the rear axle forward to the point that the cones are about [m].

    Notes
    -----
    Eqs. (16) to (21) of [VOMPC2019]_: positions and the vehicle's velocity after the step, the
    pedestrian's velocity before it, and for the interactive cone the vehicle's velocity before it as well.
    (16) is printed one-sided, (17) with misplaced parentheses, (19) without its root. The old direction of
    the hybrid cone is that of the velocity before the step, as the paper's text says; (20) mixes the new
    speed with the old heading.
    """
    if len(people) == 0:
        return np.zeros((*states.shape[:-2], 0))
    px, py = _sight(people, states, reference_point)
    new_x, new_y, old_x, old_y = _velocities(states)
    sides = [_broadcast(people.side, px)] if people.side.all() else [np.ones_like(px), -np.ones_like(px)]
    found = []
    for side in sides:
        share = _share(kind, px, py, old_x - people.along_speed, old_y - people.across_speed, side)
        wx = (1.0 + share) * new_x - share * old_x - people.along_speed
        wy = (1.0 + share) * new_y - share * old_y - people.across_speed
        bearing = _bearing(px, py, people.radius, side)
        beyond = side * (np.cos(bearing) * wy - np.sin(bearing) * wx)
        missed = side * (px * wy - py * wx) / _fast(wx, wy) - people.radius
        found.append(np.where(np.hypot(px, py) < people.radius, missed, beyond))
    result = found[0]
    if len(found) == 2:
        given = _broadcast(people.side, px)
        result = np.where(given == 0.0, np.maximum(*found), np.where(given > 0.0, *found))
    return result.reshape(*result.shape[:-2], -1)


def cone_gradients(
    kind: Cone, people: People, states: FloatArray, reference_point: float = 0.0
) -> ConeGradients:
    """Return the derivatives of one motion's margins; every ``side`` must be +1 or −1.

    Parameters are as for ``cone_margins``, states of shape (5, n + 1). At the switch of the hybrid cone
    and on the disc, where the margin has a kink, the derivatives of one side are returned.
    """
    px, py = _sight(people, states, reference_point)
    new_x, new_y, old_x, old_y = _velocities(states)
    side = _broadcast(people.side, px)
    share = _share(kind, px, py, old_x - people.along_speed, old_y - people.across_speed, side)
    wx = (1.0 + share) * new_x - share * old_x - people.along_speed
    wy = (1.0 + share) * new_y - share * old_y - people.across_speed
    bearing = _bearing(px, py, people.radius, side)
    cos, sin = np.cos(bearing), np.sin(bearing)
    by_bearing = -side * (cos * wx + sin * wy)
    squared = np.maximum(px**2 + py**2, TOUCHING**2)
    outside = squared > people.radius**2
    root = np.sqrt(np.maximum(squared - people.radius**2, TOUCHING**2))
    narrowing = side * people.radius / (squared * root)
    fast = _fast(wx, wy)
    turned = (px * wy - py * wx) / fast**2
    by_px = np.where(outside, by_bearing * (-py / squared - narrowing * px), side * wy / fast)
    by_py = np.where(outside, by_bearing * (px / squared - narrowing * py), -side * wx / fast)
    by_wx = np.where(outside, -side * sin, side * (-py - turned * wx) / fast)
    by_wy = np.where(outside, side * cos, side * (px - turned * wy) / fast)
    _, _, heading, speed, _ = states[:, 1:]
    _, _, heading_before, speed_before, _ = states[:, :-1]
    # The point that the cone is about swings round the rear axle.
    swing = reference_point * (by_px * np.sin(heading) - by_py * np.cos(heading))
    new, old = 1.0 + share, -share
    return ConeGradients(
        along=-by_px,
        across=-by_py,
        heading=swing + new * speed * (by_wy * np.cos(heading) - by_wx * np.sin(heading)),
        speed=new * (by_wx * np.cos(heading) + by_wy * np.sin(heading)),
        heading_before=old * speed_before * (by_wy * np.cos(heading_before) - by_wx * np.sin(heading_before)),
        speed_before=old * (by_wx * np.cos(heading_before) + by_wy * np.sin(heading_before)),
    )


def clearances(people: People, states: FloatArray, step: float, reference_point: float = 0.0) -> FloatArray:
    """Return the least distance from each disc's edge over one motion, shape (m,) [m]; negative within.

    Within a step, everybody goes straight on, as the vehicle does in Euler steps.

    Parameters
    ----------
    people, reference_point
        As for ``cone_margins``; the discs are those after each step.
    states
        States of one motion, shape (5, n + 1).
    step
        Length of a step [s].
    """
    if len(people) == 0:
        return np.zeros(0)
    _, _, heading, _, _ = states
    x = states[ALONG] + reference_point * np.cos(heading)
    y = states[ACROSS] + reference_point * np.sin(heading)
    begun_x = people.along[:, :1] - step * people.along_speed[:, :1]
    begun_y = people.across[:, :1] - step * people.across_speed[:, :1]
    px = np.concatenate((begun_x, people.along), axis=1) - x
    py = np.concatenate((begun_y, people.across), axis=1) - y
    dx, dy = np.diff(px, axis=1), np.diff(py, axis=1)
    squared = np.maximum(dx**2 + dy**2, 1e-12)
    share = np.clip(-(px[:, :-1] * dx + py[:, :-1] * dy) / squared, 0.0, 1.0)
    nearest = np.hypot(px[:, :-1] + share * dx, py[:, :-1] + share * dy)
    return np.asarray((nearest - people.radius).min(axis=1))


def _sight(people: People, states: FloatArray, reference_point: float) -> tuple[FloatArray, FloatArray]:
    """Return the pedestrians' positions relative to the vehicle, shape (..., m, n) each."""
    heading = states[..., None, HEADING, 1:]
    x = states[..., None, ALONG, 1:] + reference_point * np.cos(heading)
    y = states[..., None, ACROSS, 1:] + reference_point * np.sin(heading)
    return people.along - x, people.across - y


def _velocities(states: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the vehicle's velocity after and before each step, shape (..., 1, n) each."""
    heading, speed = states[..., None, HEADING, :], states[..., None, SPEED, :]
    x, y = speed * np.cos(heading), speed * np.sin(heading)
    return x[..., 1:], y[..., 1:], x[..., :-1], y[..., :-1]


def _bearing(px: FloatArray, py: FloatArray, radius: FloatArray, side: FloatArray) -> FloatArray:
    half = np.arcsin(np.minimum(radius / np.maximum(np.hypot(px, py), TOUCHING), 1.0))
    return np.asarray(np.arctan2(py, px) + side * half)


def _fast(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return speeds, with those near zero raised to a small positive value [m/s]."""
    return np.maximum(np.hypot(x, y), TOUCHING)


def _share(
    kind: Cone, px: FloatArray, py: FloatArray, old_x: FloatArray, old_y: FloatArray, side: FloatArray
) -> FloatArray:
    """Return 1 where the interactive cone counts, ``2 V_new - V_old - V_O``, and 0 for the plain one."""
    if kind is Cone.IVO:
        return np.ones_like(px)
    if kind is Cone.HYBRID:
        return np.where(side * (px * old_y - py * old_x) > 0.0, 1.0, 0.0)
    return np.zeros_like(px)


def _broadcast(side: FloatArray, shape_of: FloatArray) -> FloatArray:
    return np.broadcast_to(side[:, None], shape_of.shape)
