"""The steering plan: a quadratic program over the steering rate, for a given speed profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.mpc.horizon import LateralHorizon
from controllers.numerics import steering_program
from controllers.numerics.compiling import code_of
from controllers.numerics.steering_program import ACROSS, HEADING, STEERING_COMMAND
from controllers.programs.qp import Memory, Program

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SteeringWeights:
    """Weights of the objective; each is per second of horizon."""

    across: float = 1.0
    """[1/m^2]"""
    heading: float = 12.0
    """[1/rad^2]"""
    lateral_acceleration: float = 0.8
    """Of ``v^2 (steering / wheelbase - curvature)``, what is added to following the lane [1/(m/s^2)^2]."""
    steering: float = 2.0
    """Departure from the angle that follows the lane [1/rad^2]."""
    rate: float = 20.0
    """[1/(rad/s)^2]"""
    leaving: float = 200.0
    """Per metre outside the corridor."""


class SteeringTask(NamedTuple):
    """One steering plan to make; arrays have shape (N,)."""

    across: float
    heading_error: float
    steering: float
    command: float
    """Steering angle commanded last [rad]."""
    speed: FloatArray
    """Mean speed in each interval [m/s]."""
    curvature: FloatArray
    """Of the lane in each interval [1/m]."""
    target: FloatArray
    """Wanted offset of the rear axle [m]."""
    right: FloatArray
    """Corridor for the rear axle and the middle of the front (across) [m]."""
    left: FloatArray


class SteeringPlan(NamedTuple):
    """States at the end of each interval, shape (N,) each."""

    found: bool
    across: FloatArray
    heading_error: FloatArray
    command: FloatArray
    cost: float
    slack: float
    """Largest distance outside the corridor [m]."""
    inputs: FloatArray


class Response(NamedTuple):
    """What the inputs of a program that has been built do."""

    free: FloatArray
    """States without input, shape (4, N)."""
    gain: FloatArray
    """States by inputs, shape (4, N, N)."""
    cost: float
    """The part of the objective that no input changes, which the program leaves out."""


class LateralProgram:
    """Builds and solves steering plans of one layout.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of the steering [s].
    wheelbase
        [m].
    front
        From the rear axle to the front bumper [m].
    max_steering, max_rate
        [rad, rad/s].
    solver, tolerance, compiled
        As for :class:`controllers.programs.qp.Program`; compiled, the tasks are written by compiled code too.
    """

    LEFT, RIGHT, FRONT_LEFT, FRONT_RIGHT, STEER_LEFT, STEER_RIGHT = range(6)
    BLOCKS = 6

    def __init__(
        self,
        dt: FloatArray,
        lag: float,
        wheelbase: float,
        front: float,
        max_steering: float,
        max_rate: float,
        weights: SteeringWeights,
        solver: str = "osqp",
        tolerance: float = 1e-4,
        compiled: bool = False,
    ) -> None:
        self.steps = n = len(dt)
        self.dt = dt
        self.wheelbase = wheelbase
        self.front = front
        self.max_steering = max_steering
        self.weights = weights
        self.horizon = LateralHorizon(dt, lag, wheelbase)
        lower_triangle = np.tril(np.ones((n, n), dtype=bool))
        rows = np.zeros((self.BLOCKS * n, n + 1), dtype=bool)
        for block in range(self.BLOCKS):
            rows[self._rows(block), :n] = lower_triangle
        rows[: self._rows(self.STEER_LEFT).start, n] = True
        cost = np.zeros((n + 1, n + 1), dtype=bool)
        cost[:n, :n] = True
        cost[n, n] = True
        self.program = Program(cost, rows, solver, tolerance, compiled=compiled)
        p = self.program
        p.G[: self._rows(self.STEER_LEFT).start, n] = -1.0
        p.lower[:n], p.upper[:n] = -max_rate, max_rate
        p.lower[n] = 0.0
        p.P[n, n] = 2.0 * weights.leaving
        p.q[n] = weights.leaving
        steering = self.horizon.steering_gain
        p.G[self._rows(self.STEER_LEFT), :n] = steering
        p.G[self._rows(self.STEER_RIGHT), :n] = -steering
        w = weights
        self._limits = steering_program.Limits(
            front, max_steering, w.across, w.heading, w.steering, w.lateral_acceleration, 2.0 * w.rate * dt
        )
        # Views: what is written into them needs no copying.
        self._written = steering_program.Program(
            p.P[:n, :n], p.q[:n], p.G[: 4 * n, :n], p.h.reshape(6, n), self.horizon.gain.reshape(4 * n, n)
        )
        self._code = code_of(steering_program, compiled)

    def build(self, task: SteeringTask) -> Response:
        """Write the task into the program and return what its inputs do; overwritten by the next call."""
        free, cost = self._code.write(
            self.horizon.bicycle,
            self._limits,
            self._written,
            np.array([task.across, task.heading_error, task.steering, task.command]),
            task.speed,
            task.curvature,
            task.target,
            task.right,
            task.left,
        )
        return Response(free, self.horizon.gain, cost)

    def solve(
        self, task: SteeringTask, warm: FloatArray | None = None, memory: Memory | None = None
    ) -> SteeringPlan:
        """Return the plan for a task; ``found`` is False when the solver gave none.

        ``warm`` and ``memory`` as for :meth:`controllers.programs.qp.Program.solve`.
        """
        response = self.build(task)
        solution = self.program.solve(warm, memory=memory)
        n = self.steps
        states = response.free + (self._written.gain @ solution.z[:n]).reshape(4, n)
        return SteeringPlan(
            found=solution.found,
            across=states[ACROSS],
            heading_error=states[HEADING],
            command=states[STEERING_COMMAND],
            cost=solution.cost,
            slack=float(max(solution.z[n], 0.0)),
            inputs=solution.z,
        )

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)
