"""Where the ego's body will be along a plan, with its true corners on the true curve of the road."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray
from controllers.geometry.plane import bends, to_plane
from controllers.interface import Perception, Plan

LAG = 0.35
"""Time constant with which a braking command takes effect, the ramp of the command included [s]."""
SPACING = 0.1
"""Time between the instants of a rollout [s]."""
APART = 0.01
"""Least distance between places of a course, as a plan that stops has several instants at one place [m]."""
STEERED_FROM = 0.5
"""Planned steering assumes at least this speed, as a standing ego would get nowhere [m/s]."""
PASSING_ACCELERATION, PASSED_AFTER, BRAKING_AFTER = 2.0, 0.7, 6.5
"""Acceleration with which the ego gets past a pedestrian who walks towards its side, how long it lasts, and
deceleration afterwards [m/s^2, s, m/s^2]."""


class Course(NamedTuple):
    """The way of the rear axle, independent of the speed: k points in the order of driving."""

    along: FloatArray
    """Along coordinates, ascending, shape (k,) [m]."""
    across: FloatArray
    heading_error: FloatArray
    """Heading relative to the centre line [rad]."""


class Motion(NamedTuple):
    """Motions of m variants of a plan along a course, shape (K, m) each; the first instant is now."""

    along: FloatArray
    """Along coordinates [m]."""
    speed: FloatArray
    """[m/s]"""


def course(perception: Perception, plan: Plan, motion: Motion, times: FloatArray) -> Course:
    """Return the course of a plan: first by its steering, then by its planned places.

    Beyond its end, :func:`poses` goes straight on along the lane.

    Parameters
    ----------
    perception, plan
        What is known, and what is to be done.
    motion
        Motion of the plan itself, one variant, at ``times``.
    times
        Instants from now, shape (K,) [s].
    """
    led = _steered(perception, plan, motion, times)
    at, across, _ = led[-1]
    until = _led_until(plan)
    offset = perception.ego.across
    earlier, gone = 0.0, 0.0
    # A plain loop: NumPy's calls would take longer than the few dozen places themselves.
    knots = zip(plan.times.tolist(), plan.along.tolist(), plan.across.tolist(), strict=True)
    for time, place, beside in knots:
        if time > until:
            # An ego slower than its steering assumes reaches an offset later in time, not earlier in place.
            left = min(1.0, (time - until) / (time - earlier))
            at += left * max(place - gone, STEERED_FROM * (time - earlier))
            across += left * (beside - offset)
            before_at, before_across, _ = led[-1]
            if at > before_at + APART:
                led.append((at, across, math.atan((across - before_across) / (at - before_at))))
        earlier, gone, offset = time, place, beside
    return Course(*np.array(led).T)


def _led_until(plan: Plan) -> float:
    """Return the time until which the plan's commands determine the steering [s]."""
    return float(plan.command.times[-1])


def _steered(
    perception: Perception, plan: Plan, motion: Motion, times: FloatArray
) -> list[tuple[float, float, float]]:
    """Return the points to which the commanded steering leads, by a kinematic bicycle with steering lag.

    They are in the route frame: along, across and heading error.
    """
    ego, road = perception.ego, perception.road
    bent, step = bends(road.curvature).tolist(), road.curvature_step
    speed, command = motion.speed[:, 0].tolist(), plan.command
    until = int(np.searchsorted(times, _led_until(plan) + 1e-9))
    entry = np.searchsorted(command.times, times[:until] + 1e-9, side="right") - 1
    wanted = command.steering[np.maximum(entry, 0)].tolist()
    at, across, turned, angle = 0.0, ego.across, ego.heading_error, ego.steering
    course = [(at, across, turned)]
    share = 1.0 - math.exp(-SPACING / ego.drive.steering_lag) if ego.drive.steering_lag > 0.0 else 1.0
    for k in range(min(until, len(times) - 1)):
        before, angle = angle, angle + share * (wanted[k] - angle)
        way = 0.5 * (speed[k] + speed[k + 1]) * SPACING
        bend = bent[min(int(at / step), len(bent) - 1)] if bent else 0.0
        turn = way * math.tan(0.5 * (before + angle)) / ego.body.wheelbase
        middle = turned + 0.5 * turn
        gone = way * math.cos(middle) / max(1.0 - bend * across, 0.2)
        middle -= 0.5 * bend * gone
        at, across = at + gone, across + way * math.sin(middle)
        turned += turn - bend * gone
        if at > course[-1][0] + APART:
            course.append((at, across, turned))
    return course


def planned(perception: Perception, plan: Plan, times: FloatArray) -> Motion:
    """Return the motion that a plan demands, one variant; without a horizon, that of its first command."""
    ego = perception.ego
    if not len(plan.times):
        return braked(perception, -plan.command.acceleration[:1], times)
    knots = np.concatenate(((0.0,), plan.times))
    along = np.interp(times, knots, np.concatenate(((0.0,), plan.along)))
    return Motion(
        along[:, None], np.interp(times, knots, np.concatenate(((ego.speed,), plan.speed)))[:, None]
    )


def braked(perception: Perception, braking: FloatArray, times: FloatArray) -> Motion:
    """Return the motions for m constant braking commands [m/s^2] from now on; negative ones speed up."""
    ego = perception.ego
    wanted = -np.asarray(braking, dtype=np.float64)[None, :]
    reached = wanted + (ego.acceleration - wanted) * np.exp(-times[:, None] / LAG)
    step = np.diff(times, prepend=0.0)[:, None]
    speed = np.maximum(ego.speed + np.cumsum(step * reached, axis=0), 0.0)
    # Whoever brakes to a standstill stays there.
    speed = np.where((np.minimum.accumulate(speed, axis=0) <= 0.0) & (wanted <= 0.0), 0.0, speed)
    before = np.concatenate((np.full((1, speed.shape[1]), ego.speed), speed[:-1]))
    return Motion(np.cumsum(step * 0.5 * (before + speed), axis=0), speed)


def passing_first(perception: Perception, times: FloatArray) -> Motion:
    """Return the motion, one variant, that speeds up a little to get past a pedestrian, and then brakes."""
    ego = perception.ego
    acceleration, speed, along = ego.acceleration, ego.speed, 0.0
    way = [(0.0, speed)]
    for before, now in pairwise(times.tolist()):
        wanted = PASSING_ACCELERATION if before < PASSED_AFTER else -BRAKING_AFTER
        acceleration = wanted + (acceleration - wanted) * math.exp(-(now - before) / LAG)
        reached = max(speed + acceleration * (now - before), 0.0)
        along += 0.5 * (speed + reached) * (now - before)
        speed = reached
        way.append((along, speed))
    places = np.array(way)
    return Motion(places[:, :1], places[:, 1:])


def poses(perception: Perception, path: Course, motion: Motion) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle in the plane of the route frame, shape (K, m) each."""
    shape = motion.along.shape
    along = motion.along.ravel()
    across = np.interp(along, path.along, path.across)
    turned = np.interp(along, path.along, path.heading_error)
    turned = np.where(along > path.along[-1], 0.0, turned)
    places, heading = to_plane(perception.road, along, across)
    return places[:, 0].reshape(shape), places[:, 1].reshape(shape), (heading + turned).reshape(shape)
