"""The last plan moved to the present, and profiles between a plan's instants."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray


def moved(
    times: FloatArray, position: FloatArray, speed: FloatArray, age: float
) -> tuple[FloatArray, FloatArray]:
    """Return positions from now, and speeds, of a plan made ``age`` seconds ago, shape (N,) each [m, m/s].

    Parameters
    ----------
    times : horizon, shape (N,) [s]
    position, speed : planned for ``times`` when the plan was made, shape (N,)
    age : time since the plan was made [s]
    """
    at = times + age
    travelled = np.interp(np.array([age]), _after(0.0, times), _after(0.0, position))
    beyond = np.maximum(at - times[-1], 0.0) * speed[-1]
    return np.interp(at, times, position) + beyond - travelled, np.interp(at, times, speed)


def sampled(
    times: FloatArray,
    acceleration_now: float,
    acceleration: FloatArray,
    steering_now: float,
    steering: FloatArray,
    spacing: float,
    duration: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return instants from now on, and two profiles sampled in the middle of the interval after each.

    Parameters
    ----------
    times : horizon, shape (N,) [s]
    acceleration_now, steering_now : values of the profiles now
    acceleration, steering : values of the profiles at ``times``, linear in between, shape (N,)
    spacing, duration : spacing of the instants, and the time that they span [s]
    """
    starts = np.arange(0.0, duration, spacing)
    middle = starts + 0.5 * spacing
    knots = _after(0.0, times)
    accelerations = np.interp(middle, knots, _after(acceleration_now, acceleration))
    return starts, accelerations, np.interp(middle, knots, _after(steering_now, steering))


def in_intervals(
    position: FloatArray, speed_now: float, speed: FloatArray, curvature: FloatArray, curvature_step: float
) -> tuple[FloatArray, FloatArray]:
    """Return mean speed and the road's curvature in the middle of each interval, shape (N,) each.

    Parameters
    ----------
    position, speed : at the end of each interval, shape (N,) [m, m/s]
    speed_now : speed at the beginning of the first interval [m/s]
    curvature, curvature_step : as in ``RoadAhead``; the road is straight if ``curvature`` is empty
    """
    middle = 0.5 * (position + _after(0.0, position[:-1]))
    mean = 0.5 * (speed + _after(speed_now, speed[:-1]))
    if len(curvature) == 0:
        return mean, np.zeros(len(middle))
    return mean, np.interp(middle, np.arange(len(curvature)) * curvature_step, curvature)


def _after(first: float, others: FloatArray) -> FloatArray:
    # For few numbers, this is several times as fast as np.concatenate, which has to make ``first`` an array.
    both = np.empty(len(others) + 1)
    both[0], both[1:] = first, others
    return both
