"""The steering plan: a quadratic program over the steering rate, for a given speed profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory, solve
from controllers.velocity_obstacle.mpc.arithmetic import steering_program
from controllers.velocity_obstacle.mpc.arithmetic.steering_program import ACROSS, HEADING, STEERING_COMMAND
from controllers.velocity_obstacle.mpc.horizon import LateralHorizon


@dataclass(frozen=True, slots=True)
class SteeringWeights:
    """Weights of the objective; each is per second of horizon."""

    across: float = 1.0
    """[1/m^2]"""
    heading: float = 12.0
    """[1/rad^2]"""
    lateral_acceleration: float = 0.8
    """Weight of lateral acceleration beyond that of the lane, ``v^2 (steering / wheelbase - curvature)``
    [1/(m/s^2)^2]."""
    steering: float = 2.0
    """Weight of deviation from the steering angle that follows the lane [1/rad^2]."""
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
    """Curvature of the lane in each interval [1/m]."""
    target: FloatArray
    """Wanted offset of the rear axle [m]."""
    right: FloatArray
    """Right edge of the corridor for the rear axle and the middle of the front; ``left`` is the other [m]."""
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
    """Response of a built problem to its inputs."""

    free: FloatArray
    """States without input, shape (4, N)."""
    gain: FloatArray
    """Map from inputs to states, shape (4, N, N)."""
    cost: float
    """Part of the objective that does not depend on the inputs, which the problem leaves out."""


class LateralProgram:
    """Builds and solves steering programs that share one layout.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of the steering [s].
    wheelbase
        Distance between the axles [m].
    front
        Distance from the rear axle to the front bumper [m].
    max_steering, max_rate
        Limits of the steering angle and the steering rate [rad, rad/s].
    solver
        Settings of the solver.
    """

    LEFT, RIGHT, FRONT_LEFT, FRONT_RIGHT, STEER_LEFT, STEER_RIGHT = range(6)
    ROWS = (
        "rear axle right of the corridor's left edge [m], softened",
        "rear axle left of its right edge [m], softened",
        "front right of its left edge [m], softened",
        "front left of its right edge [m], softened",
        "steering angle below its limit [rad]",
        "steering angle above its limit [rad]",
    )

    def __init__(
        self,
        dt: FloatArray,
        lag: float,
        wheelbase: float,
        front: float,
        max_steering: float,
        max_rate: float,
        weights: SteeringWeights,
        solver: SolverSettings | None = None,
    ) -> None:
        self.steps = n = len(dt)
        self.dt = dt
        self.wheelbase = wheelbase
        self.front = front
        self.max_steering = max_steering
        self.weights = weights
        self.horizon = LateralHorizon(dt, lag, wheelbase)
        self.solver = solver or SolverSettings()
        self.problem: Problem = blank(
            f"sum dt [{weights.across:g} (d - d_target)^2 + {weights.heading:g} heading^2 "
            f"+ ({weights.steering:g} + {weights.lateral_acceleration:g} v^4 / wheelbase^2) "
            f"(steer - steer_lane)^2 + {weights.rate:g} rate^2] + softened rows",
            {"steering rate [rad/s]": n, "outside the corridor [m]": 1},
            dict.fromkeys(self.ROWS, n),
        )
        p = self.problem
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
        # These are views, so what is written into them needs no copying.
        self._written = steering_program.Program(
            p.P[:n, :n],
            np.einsum("ii->i", p.P[:n, :n]),
            p.q[:n],
            p.G[: 4 * n, :n],
            p.h.reshape(6, n),
            self.horizon.gain.reshape(4 * n, n),
        )

    def build(self, task: SteeringTask) -> Response:
        """Write the task into the problem and return the response to inputs; the next call overwrites it."""
        free, cost = steering_program.write(
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
        self, task: SteeringTask, start: FloatArray | None = None, memory: Memory | None = None
    ) -> SteeringPlan:
        """Return the plan for a task; ``found`` is False when it was not solved.

        ``start`` and ``memory`` as for :func:`controllers.optimisation.solve.solve`.
        """
        response = self.build(task)
        solution = solve(self.problem, self.solver, memory, start)
        n = self.steps
        states = response.free + (self._written.gain @ solution.z[:n]).reshape(4, n)
        return SteeringPlan(
            found=solution.solved,
            across=states[ACROSS],
            heading_error=states[HEADING],
            command=states[STEERING_COMMAND],
            cost=solution.cost,
            slack=float(max(solution.z[n], 0.0)),
            inputs=solution.z,
        )

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)
