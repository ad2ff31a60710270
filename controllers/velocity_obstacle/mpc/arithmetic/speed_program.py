"""The parts of a speed program that change from task to task; see ``mpc.longitudinal``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray

BLOCKS = 9
UPPER, LOWER, STOPPABLE, HEADWAY, FAST, SLOW, BRAKE, JERK_UP, JERK_DOWN = range(BLOCKS)
"""Blocks of N rows, in order; the bounds of the last two do not change."""
POSITION, SPEED, ACCELERATION, COMMAND = range(4)
"""Rows of the longitudinal states."""
NEAR = 0.3
"""The linearised braking distance is accurate enough this near to the speed of linearisation [m/s]."""


class Layout(NamedTuple):
    """Constants that do not change with the task, for N intervals."""

    start: FloatArray
    """Map from the states at the start to all states, shape (4 N, 4)."""
    speed_gain: FloatArray
    """Map from inputs to speeds, shape (N, N)."""
    stoppable_position: FloatArray
    """Scaled rows of the braking distance, shape (N, N): for the position, and per second for the speed."""
    stoppable_speed: FloatArray
    speed_cost: FloatArray
    """Map from speed errors, or from accelerations, to the gradient of the cost, shape (N, N) each."""
    acceleration_cost: FloatArray
    row_scale: FloatArray
    """Scales of the rows of each block, shape (7, N)."""
    half_jerk: FloatArray
    """Change of the command until each instant at half the largest jerk, shape (N,) [m/s^2]."""
    acceleration: float
    comfortable_braking: float
    emergency_braking: float
    freeze_braking: float
    headway: float


class Program(NamedTuple):
    """The arrays that tasks are written to: views of the program's arrays."""

    q: FloatArray
    """Linear costs of the inputs, shape (N,)."""
    stoppable: FloatArray
    """Rows of the braking distance, shape (N, N)."""
    bounds: FloatArray
    """Bounds of the rows of each block, shape (7, N)."""
    upper: FloatArray
    """Upper bounds of the inputs, shape (N,)."""


def write(
    layout: Layout,
    program: Program,
    speed_now: float,
    acceleration_now: float,
    command_now: float,
    reference: FloatArray,
    expected: FloatArray,
    upper: FloatArray,
    lower: FloatArray,
    stoppable: FloatArray,
    headway: FloatArray,
    ceiling: FloatArray,
) -> FloatArray:
    """Write a task into the program; arguments as in ``SpeedTask``, with ceiling inf if there is none.

    Returns
    -------
    The states without input, shape (4, N).
    """
    h, v = program.bounds, layout.speed_gain
    now = np.array([0.0, speed_now, acceleration_now, command_now])
    free: FloatArray = (layout.start @ now).reshape(4, -1)
    position, speed = free[POSITION], free[SPEED]
    program.q[:] = layout.speed_cost @ (speed - reference) + layout.acceleration_cost @ free[ACCELERATION]
    h[UPPER] = upper - position
    h[LOWER] = position - lower
    slope = np.maximum(expected, 0.0) / layout.freeze_braking
    program.stoppable[:] = layout.stoppable_position + slope.reshape(-1, 1) * layout.stoppable_speed
    h[STOPPABLE] = stoppable + 0.5 * slope * expected - position - slope * speed
    h[HEADWAY] = headway - position - layout.headway * speed
    # Bounds that the state may already violate are moved to what is still reachable, because the program
    # must have a solution from any state.
    present = speed_now + 0.5 * max(acceleration_now, 0.0)
    fastest = np.minimum(max(reference.max(), present) + 0.3, ceiling)
    slowed = v @ towards(-layout.comfortable_braking, command_now, layout.half_jerk)
    h[FAST] = np.maximum(fastest - speed, slowed + 0.05)
    recovered = v @ towards(layout.acceleration, command_now, layout.half_jerk)
    h[SLOW] = np.maximum(speed, 0.05 - recovered)
    # The last check may have braked harder than a plan may: such braking is eased at half the largest jerk.
    beyond = layout.emergency_braking - layout.comfortable_braking
    h[BRAKE] = np.maximum(layout.comfortable_braking + free[COMMAND], -beyond - layout.half_jerk)
    h *= layout.row_scale
    program.upper[:] = max(layout.acceleration - command_now, 0.0)
    return free


def towards(command: float, present: float, half_jerk: FloatArray) -> FloatArray:
    """Return the inputs that reach half of a command at half the largest jerk, so some freedom is left."""
    step = 0.5 * command - present
    return np.minimum(half_jerk, step) if step > 0.0 else np.maximum(-half_jerk, step)


def states(
    free: FloatArray,
    gain: FloatArray,
    z: FloatArray,
    reference: FloatArray,
    dt: FloatArray,
    weights: FloatArray,
) -> tuple[FloatArray, float]:
    """Return the states that the inputs at the head of ``z`` lead to, and the cost without any inputs.

    Parameters
    ----------
    free : states without input, shape (4, N)
    gain : map from inputs to states, shape (4 N, N)
    z : inputs and slacks
    reference, dt : wanted speeds and interval lengths, shape (N,) [m/s, s]
    weights : weights of the squares of speed error and acceleration, shape (2,)
    """
    n = len(dt)
    reached = free + (gain @ z[:n]).reshape(4, n)
    reached[SPEED] = np.maximum(reached[SPEED], 0.0)
    errors = weights[0] * (free[SPEED] - reference) ** 2 + weights[1] * free[ACCELERATION] ** 2
    return reached, float(dt @ errors)


def departs(expected: FloatArray, speed: FloatArray, stoppable: FloatArray) -> bool:
    """Return whether speeds are far from the expected ones wherever the ego must be able to stop."""
    return bool(((np.abs(speed - expected) > NEAR) & np.isfinite(stoppable)).any())
