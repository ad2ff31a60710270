"""Steering down a potential field with a car that has a heading, limits and lags.

The direction of steepest descent is the desired heading of the car. The curvature command is the rate at
which that direction turns along the way, plus a part that reduces the heading error. Applied to a kinematic
bicycle model, the law also says where the car would really go, for several fields at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState, RoadAhead
from controllers.potential_field.field import Field

TURNED_OVER = 0.5
"""Distance over which the turning of the direction of descent is measured [m]."""
_BEGIN_AND_END = np.array([[0.0], [TURNED_OVER]])
"""The two ends of that distance [m]."""


@dataclass(frozen=True, slots=True)
class Guidance:
    """Parameters for following the field."""

    heading_time: float = 0.3
    """Time constant with which the heading error decays [s]."""
    heading_length: float = 1.4
    """Length constant that takes the place of ``heading_time`` at low speed [m]."""
    preview: float = 0.12
    """How far ahead the field is evaluated, because the wheels need time to turn [s]."""
    lateral_acceleration: float = 4.0
    """Largest lateral acceleration, the road's own curve included [m/s^2]."""
    lateral_speed: float = 4.0
    """Largest lateral speed [m/s]."""
    steepest: float = 0.5
    """Largest angle to the road [rad]."""


@dataclass(frozen=True, slots=True)
class Drives:
    """Where the rear axle would go at K instants in m fields, in the route frame."""

    times: FloatArray
    """Shape (K,), from 0 [s]."""
    along: FloatArray
    """Shape (K, m) [m]."""
    across: FloatArray
    heading: FloatArray
    """Relative to the road [rad]."""
    speed: FloatArray
    """Shape (K,) [m/s]."""
    angle: FloatArray
    """Commanded front-wheel angles over the steps, shape (K − 1, m) [rad]."""


def drive(
    shape: Field,
    count: int,
    ego: EgoState,
    road: RoadAhead,
    speeds: FloatArray,
    step: float,
    guidance: Guidance | None = None,
) -> Drives:
    """Return how the car would drive in several fields.

    Parameters
    ----------
    shape : the fields, as one field with arrays of shape (count,)
    count : number m of fields
    ego : state of the ego at the beginning
    road : the road, for the curvature of the reference lane
    speeds : speeds at the beginning of every step and at the end of the last, shape (K,) [m/s]
    step : duration of a step [s]
    guidance : how to follow the field
    """
    guidance = guidance or Guidance()
    instants = len(speeds)
    along, across, heading = (np.zeros((instants, count)) for _ in range(3))
    angle = np.zeros((instants - 1, count))
    across[0], heading[0] = ego.across, ego.heading_error
    realised = np.full(count, ego.steering)
    limits, wheelbase = ego.drive, ego.body.wheelbase
    bend_at = _bend_of(road)
    for k in range(instants - 1):
        now, speed = k * step, 0.5 * float(speeds[k] + speeds[k + 1])
        x, y, psi = along[k], across[k], heading[k]
        bend = bend_at(x)
        stretch = np.maximum(1.0 - bend * y, 0.2)
        angle[k] = _angle(shape, (x, y, psi), realised, bend / stretch, speed, now, ego, guidance)
        rate = (angle[k] - realised) / max(limits.steering_lag, step)
        turned = realised + step * _within(rate, limits.max_steering_rate)
        onward = speed * np.cos(psi) / stretch
        turn = speed * np.tan(0.5 * (realised + turned)) / wheelbase - bend * onward
        along[k + 1] = x + step * onward
        across[k + 1] = y + step * speed * np.sin(psi + 0.5 * step * turn)
        heading[k + 1] = psi + step * turn
        realised = turned
    return Drives(step * np.arange(instants, dtype=np.float64), along, across, heading, speeds, angle)


def _angle(
    shape: Field,
    state: tuple[FloatArray, FloatArray, FloatArray],
    realised: FloatArray,
    bend: FloatArray,
    speed: float,
    now: float,
    ego: EgoState,
    guidance: Guidance,
) -> FloatArray:
    """Return the front-wheel angle that follows the field, as seen from the place one preview ahead [rad]."""
    x, y, psi = state
    wheelbase = ego.body.wheelbase
    early = speed * guidance.preview
    psi = psi + early * (np.tan(realised) / wheelbase - bend)
    cosine, sine = np.cos(psi), np.sin(psi)
    x, y = x + early * cosine, y + early * sine
    later = _BEGIN_AND_END / max(speed, 1.0)
    wanted = shape.heading(
        x + _BEGIN_AND_END * cosine, y + _BEGIN_AND_END * sine, now + guidance.preview + later
    )
    steepest = min(guidance.steepest, guidance.lateral_speed / max(speed, 0.1))
    begin, end = _within(wanted, steepest)
    settling = max(guidance.heading_length, speed * guidance.heading_time)
    curvature = bend * cosine + (end - begin) / TURNED_OVER + (begin - psi) / settling
    strongest = guidance.lateral_acceleration / max(speed * speed, 1.0)
    wheel = np.arctan(wheelbase * _within(curvature, strongest))
    return _within(wheel, ego.drive.max_steering)


def _within(values: FloatArray, bound: float) -> FloatArray:
    """Return values within ± a bound, for these small arrays in half the time of ``np.clip``."""
    return np.minimum(np.maximum(values, -bound), bound)


def _bend_of(road: RoadAhead) -> Callable[[FloatArray], FloatArray]:
    """Return the curvature of the reference lane over the way along it; 0 beyond the view [1/m]."""
    bends = road.curvature
    if road.curvature_step <= 0.0 or not bends.any():
        return np.zeros_like
    places = np.arange(len(bends)) * road.curvature_step
    return lambda along: np.interp(along, places, bends, right=0.0)
