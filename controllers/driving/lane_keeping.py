"""Steering along a lane, or over to another one, that also works when a plan lasts a second.

The control law is written in space, so that it works from standstill on, and in cascade: the distance to the
lane demands a heading, the heading a curvature. The law is simulated over the plan interval with a kinematic
bicycle, and the wheel angles of this simulation are the command.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState, Perception, RoadAhead

STEP = 0.05
"""Spacing of the steering sequence [s]."""
LONGEST = 40
"""Entries of the longest sequence; in a plan interval beyond 2 s, its last angle is held."""


@dataclass(frozen=True, slots=True)
class LaneKeeping:
    """How briskly to steer."""

    approach_time: float = 1.0
    """Time constant with which the distance to the lane decays [s]."""
    heading_time: float = 0.35
    """Time constant with which the heading error decays [s]."""
    approach_length: float = 4.0
    """Distance that replaces ``approach_time`` at low speed [m]."""
    heading_length: float = 1.4
    """Distance that replaces ``heading_time`` at low speed [m]."""
    lateral_speed: float = 1.3
    """Fastest movement across the road [m/s]."""
    approach_angle: float = 0.55
    """Steepest angle to the lane at low speed [rad]."""
    correction: float = 2.0
    """Lateral acceleration that a correction may use in addition to that of the curve [m/s^2]."""
    lateral_acceleration: float = 4.5
    """Lateral acceleration that is never exceeded, curve included [m/s^2]."""
    preview: float = 0.2
    """How early the ego steers for a coming bend, because the wheel needs time to turn [s]."""


@dataclass(frozen=True, slots=True)
class Place:
    """One point of a course, at a given place along the lane."""

    across: float
    """Across coordinate [m]."""
    slope: float
    """Derivative of ``across`` along the lane."""
    bend: float
    """Derivative of ``slope`` along the lane [1/m]."""


class Course(Protocol):
    """A curve to follow, in the route frame."""

    def at(self, along: float) -> Place:
        """Return the place of the curve at an along coordinate [m]."""
        ...


@dataclass(frozen=True, slots=True)
class Parallel:
    """A course at a constant distance from the lane's centre line."""

    across: float

    def at(self, along: float) -> Place:
        """Return the place; it is the same everywhere."""
        return Place(self.across, 0.0, 0.0)


def instants(ego: EgoState) -> FloatArray:
    """Return the times from now at which a command over the ego's plan interval changes [s]."""
    count = min(max(math.ceil(ego.plan_interval / STEP - 1e-9), 1), LONGEST)
    return np.arange(count, dtype=np.float64) * STEP


def steering(
    perception: Perception,
    target: float | Course,
    acceleration: FloatArray,
    style: LaneKeeping | None = None,
) -> FloatArray:
    """Return the front-wheel angles [rad] that lead the rear axle to an across offset, one per instant.

    Parameters
    ----------
    perception : gives the ego's place and the curvature of its lane
    target : across coordinate to go to, for instance ``Lane.offset`` [m], or a curve to follow
    acceleration : accelerations commanded meanwhile, at ``instants(perception.ego)`` [m/s^2]
    style : how briskly to steer

    Notes
    -----
    With lateral error e, heading error ψ, lengths ℓ_e = max(approach_length, v · approach_time) and ℓ_ψ
    likewise: ψ* = −e / ℓ_e within limits, curvature = curve + ((ψ* − ψ) / ℓ_ψ − sin ψ / ℓ_e). Near the
    lane both poles are real, −1 / ℓ_e and −1 / ℓ_ψ, so the ego reaches it without overshoot. For a curve to
    follow, e and ψ are measured from it and its own curvature is added.
    """
    style = style or LaneKeeping()
    ego, road = perception.ego, perception.road
    course = Parallel(target) if isinstance(target, int | float) else target
    state = Bicycle(ego)
    angles = np.zeros(len(acceleration))
    for i, wanted in enumerate(acceleration):
        angles[i] = _angle(state, road, course, style)
        state.move(float(wanted), float(angles[i]), road)
    return angles


class Bicycle:
    """A kinematic bicycle in the route frame with the lags of the ego; it starts in the ego's state."""

    def __init__(self, ego: EgoState) -> None:
        self.ego = ego
        self.along = 0.0
        self.across = ego.across
        self.heading = ego.heading_error
        self.speed = max(ego.speed, 0.0)
        self.acceleration = ego.acceleration
        self.angle = ego.steering

    def move(self, acceleration: float, angle: float, road: RoadAhead) -> None:
        """Drive for ``STEP`` seconds with a commanded acceleration [m/s^2] and wheel angle [rad]."""
        drive = self.ego.drive
        rate = (angle - self.angle) / max(drive.steering_lag, STEP)
        turned = self.angle + STEP * min(max(rate, -drive.max_steering_rate), drive.max_steering_rate)
        share = -math.expm1(-STEP / drive.drive_lag) if drive.drive_lag > 0.0 else 1.0
        self.acceleration += share * (acceleration - self.acceleration)
        middle = max(self.speed + 0.5 * STEP * self.acceleration, 0.0)
        bend = math.tan(0.5 * (self.angle + turned)) / self.ego.body.wheelbase
        here = curvature_at(road, self.along)
        onward = middle * math.cos(self.heading) / _stretch(here, self.across)
        turn = middle * bend - here * onward
        self.across += STEP * middle * math.sin(self.heading + 0.5 * STEP * turn)
        self.heading += STEP * turn
        self.along += STEP * onward
        self.speed = max(self.speed + STEP * self.acceleration, 0.0)
        self.angle = turned


def _angle(state: Bicycle, road: RoadAhead, course: Course, style: LaneKeeping) -> float:
    speed = state.speed
    here, soon = course.at(state.along), course.at(state.along + 0.5 * speed * style.preview)
    direction = math.atan(here.slope)
    approach = max(style.approach_length, speed * style.approach_time)
    settling = max(style.heading_length, speed * style.heading_time)
    steepest = min(style.approach_angle, style.lateral_speed / max(speed, 0.1))
    error = state.across - here.across
    wanted = -error / approach
    moving = math.sin(state.heading - direction) / approach
    if abs(wanted) > steepest:
        wanted, moving = math.copysign(steepest, wanted), 0.0
    correction = (wanted + direction - state.heading) / settling - moving
    squared = max(speed * speed, 1.0)
    correction = _within(correction, style.correction / squared)
    # The wheel follows late, so the curvature is the mean between here and the preview.
    ahead = [curvature_at(road, state.along + speed * style.preview * share) for share in (0.0, 0.5, 1.0)]
    curve = sum(ahead) / len(ahead)
    curve *= math.cos(state.heading) / _stretch(curve, state.across)
    curve += soon.bend * math.cos(math.atan(soon.slope)) ** 3
    total = _within(curve + correction, style.lateral_acceleration / squared)
    return _within(math.atan(state.ego.body.wheelbase * total), state.ego.drive.max_steering)


def curvature_at(road: RoadAhead, along: float) -> float:
    """Return the reference lane's curvature [1/m], 0 where the view has ended."""
    if len(road.curvature) == 0 or road.curvature_step <= 0.0:
        return 0.0
    place = max(along / road.curvature_step, 0.0)
    left = int(place)
    if left + 1 >= len(road.curvature):
        return float(road.curvature[-1]) if place <= len(road.curvature) - 1 else 0.0
    share = place - left
    return float((1.0 - share) * road.curvature[left] + share * road.curvature[left + 1])


def _stretch(curvature: float, across: float) -> float:
    """Return the length of the path relative to that of the lane; at least 0.2 near a bend's centre."""
    return max(1.0 - curvature * across, 0.2)


def _within(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
