"""Where the body will be along a plan, true to its corners and to the curve of the road."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.driving.plane import to_plane
from controllers.interface import FloatArray, Perception, Plan

LAG = 0.35
"""Time constant with which a braking command takes hold, the ramp of the command included [s]."""
SPACING = 0.1
"""Between instants of a rollout [s]."""
STEERED_FROM = 0.5
"""Steering is planned as if the ego were at least so fast: standing wheels lead nowhere [m/s]."""


class Course(NamedTuple):
    """Where the rear axle goes, whatever the speed: k points in the order of driving."""

    along: FloatArray
    """Along the route, ascending, shape (k,) [m]."""
    across: FloatArray
    heading_error: FloatArray
    """To the centre line [rad]."""


class Motion(NamedTuple):
    """How m variants of a plan move along a course, shape (K, m) each; the first instant is now."""

    along: FloatArray
    """Along the route [m]."""
    speed: FloatArray
    """[m/s]"""


def course(perception: Perception, plan: Plan) -> Course:
    """Return the course of a plan, straight on along the lane where it has none and beyond its end."""
    ego = perception.ego
    # An ego slower than its steering supposes gets to each offset later in time, not earlier in place.
    driven = np.diff(plan.along, prepend=0.0)
    steered = np.maximum(driven, STEERED_FROM * np.diff(plan.times, prepend=0.0))
    along, across = np.append(0.0, np.cumsum(steered)), np.append(ego.across, plan.across)
    # A plan that stops has several instants at one place.
    onward = np.append(True, np.diff(np.maximum.accumulate(along)) > 0.01)
    along, across = along[onward], across[onward]
    heading = np.full(len(along), ego.heading_error)
    if len(along) > 1:
        heading[1:] = np.arctan(np.diff(across) / np.diff(along))
    return Course(along, across, heading)


def planned(perception: Perception, plan: Plan, times: FloatArray) -> Motion:
    """Return the motion that a plan asks for, one variant; without a horizon, what it commands at first."""
    ego = perception.ego
    if not len(plan.times):
        return braked(perception, -plan.command.acceleration[:1], times)
    knots = np.append(0.0, plan.times)
    along = np.interp(times, knots, np.append(0.0, plan.along))
    return Motion(along[:, None], np.interp(times, knots, np.append(ego.speed, plan.speed))[:, None])


def braked(perception: Perception, braking: FloatArray, times: FloatArray) -> Motion:
    """Return the motion of m constant braking commands from now on; negative ones speed up [m/s^2]."""
    ego = perception.ego
    wanted = -np.asarray(braking, dtype=np.float64)[None, :]
    reached = wanted + (ego.acceleration - wanted) * np.exp(-times[:, None] / LAG)
    step = np.diff(times, prepend=0.0)[:, None]
    speed = np.maximum(ego.speed + np.cumsum(step * reached, axis=0), 0.0)
    speed = np.where(np.minimum.accumulate(speed, axis=0) <= 0.0, 0.0, speed)
    before = np.concatenate((np.full((1, speed.shape[1]), ego.speed), speed[:-1]))
    return Motion(np.cumsum(step * 0.5 * (before + speed), axis=0), speed)


def poses(perception: Perception, path: Course, motion: Motion) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle in the plane of the route frame, shape (K, m) each."""
    shape = motion.along.shape
    along = motion.along.ravel()
    across = np.interp(along, path.along, path.across)
    turned = np.interp(along, path.along, path.heading_error)
    turned = np.where(along > path.along[-1], 0.0, turned)
    places, heading = to_plane(perception.road, along, across)
    return places[:, 0].reshape(shape), places[:, 1].reshape(shape), (heading + turned).reshape(shape)
