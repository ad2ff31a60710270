"""The parts of a steering program that change from task to task; see ``mpc.lateral``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray

ACROSS, HEADING, STEERING, STEERING_COMMAND = range(4)
"""Rows of the lateral states."""


class Bicycle(NamedTuple):
    """How steering moves the ego over N intervals, independent of the speed."""

    dt: FloatArray
    """Interval lengths, shape (N,) [s]."""
    turned: FloatArray
    """Heading that an interval adds per ``v / wheelbase``, by inputs and start, shape (N, N + 2)."""
    moved: FloatArray
    """Offset that it adds per ``v^2 / wheelbase``, by inputs and start, shape (N, N + 2)."""
    steering_start: FloatArray
    """Maps from steering angle and command at the start to each of them later, shape (N, 2) each."""
    command_start: FloatArray
    wheelbase: float


class Limits(NamedTuple):
    """Other constants that do not change with the task; weights are per second."""

    front: float
    """Distance from the rear axle to the front bumper [m]."""
    max_steering: float
    across: float
    """Weights, as in ``SteeringWeights``."""
    heading: float
    steering: float
    lateral_acceleration: float
    rate_cost: FloatArray
    """Twice the weight of each input's square, shape (N,)."""


class Program(NamedTuple):
    """The arrays that tasks are written to: views of the program's, and the map from inputs to states."""

    P: FloatArray
    """Quadratic costs of the inputs, shape (N, N)."""
    diagonal: FloatArray
    """Diagonal of ``P``, shape (N,)."""
    q: FloatArray
    """Linear costs of the inputs, shape (N,)."""
    rows: FloatArray
    """Rows of the corridor: rear axle and front, each left and right, by inputs, shape (4 N, N)."""
    bounds: FloatArray
    """Bounds of all rows, shape (6, N)."""
    gain: FloatArray
    """Map from inputs to states, shape (4 N, N)."""


def maps(
    bicycle: Bicycle, gain: FloatArray, start: FloatArray, speed: FloatArray, curvature: FloatArray
) -> FloatArray:
    """Write the maps from inputs to offset and heading, and return the states without input, shape (4, N).

    Parameters
    ----------
    bicycle : see :class:`Bicycle`
    gain : map from inputs to states, shape (4 N, N)
    start : offset, heading error, steering angle and its command now, shape (4,)
    speed, curvature : mean values in each interval, shape (N,) [m/s, 1/m]
    """
    n, free = len(speed), np.empty((4, len(speed)))
    per_wheelbase = speed / bicycle.wheelbase
    travelled = speed * bicycle.dt
    heading, across = accumulated(bicycle.turned, bicycle.moved, per_wheelbase, speed, travelled)
    gain[:n], gain[n : 2 * n] = across[:, :n], heading[:, :n]
    # Without input: the effect of the wheels' initial angle, less the turning of the lane.
    wheels = start[STEERING:]
    turns = curvature * travelled
    lane_heading = start[HEADING] - np.cumsum(turns)
    free[HEADING] = lane_heading + (heading[:, n] * wheels[0] + heading[:, n + 1] * wheels[1])
    free[ACROSS] = start[ACROSS] + (across[:, n] * wheels[0] + across[:, n + 1] * wheels[1])
    free[ACROSS] += np.cumsum(travelled * (lane_heading + 0.5 * turns))
    free[STEERING] = bicycle.steering_start @ wheels
    free[STEERING_COMMAND] = bicycle.command_start @ wheels
    return free


def write(
    bicycle: Bicycle,
    limits: Limits,
    program: Program,
    start: FloatArray,
    speed: FloatArray,
    curvature: FloatArray,
    target: FloatArray,
    right: FloatArray,
    left: FloatArray,
) -> tuple[FloatArray, float]:
    """Write a task into the program; arguments as in ``SteeringTask`` and :func:`maps`.

    Returns
    -------
    The states without input, shape (4, N), and the objective for them.
    """
    n, gain = len(speed), program.gain[: 3 * len(speed)]
    free = maps(bicycle, program.gain, start, speed, curvature)
    weights, errors = np.empty((3, n)), np.empty((3, n))
    weights[0], weights[1] = limits.across * bicycle.dt, limits.heading * bicycle.dt
    # Lateral acceleration beyond that of following the lane, as a weight on the steering angle.
    bend = (speed**2 / bicycle.wheelbase) ** 2
    weights[2] = (limits.steering + limits.lateral_acceleration * bend) * bicycle.dt
    errors[0], errors[1] = free[ACROSS] - target, free[HEADING]
    errors[2] = free[STEERING] - bicycle.wheelbase * curvature
    weighted = gain * (2.0 * weights).reshape(-1, 1)
    program.P[:] = gain.T @ weighted
    program.diagonal[:] += limits.rate_cost
    program.q[:] = errors.reshape(-1) @ weighted
    rows, h = program.rows, program.bounds
    rows[:n], rows[n : 2 * n] = gain[:n], -gain[:n]
    rows[2 * n : 3 * n] = gain[:n] + limits.front * gain[n : 2 * n]
    rows[3 * n :] = -rows[2 * n : 3 * n]
    front_free = free[ACROSS] + limits.front * free[HEADING]
    h[0], h[1] = left - free[ACROSS], free[ACROSS] - right
    h[2], h[3] = left - front_free, front_free - right
    h[4], h[5] = limits.max_steering - free[STEERING_COMMAND], limits.max_steering + free[STEERING_COMMAND]
    return free, float((weights * errors**2).sum())


def accumulated(
    turned: FloatArray, moved: FloatArray, per_wheelbase: FloatArray, speed: FloatArray, travelled: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the maps from inputs and start to heading and offset after each interval, shape (N, N + 2)."""
    heading = np.add.accumulate(per_wheelbase[:, None] * turned, axis=0)
    steps = (speed * per_wheelbase)[:, None] * moved
    steps[1:] += travelled[1:, None] * heading[:-1]
    return heading, np.add.accumulate(steps, axis=0)
