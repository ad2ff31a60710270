"""The steering plan: a quadratic program over the steering rate, for a given speed profile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.mpc.horizon import ACROSS, HEADING, STEERING, STEERING_COMMAND, LateralHorizon
from controllers.programs.qp import Program

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


@dataclass(frozen=True, slots=True)
class SteeringTask:
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


@dataclass(frozen=True, slots=True)
class SteeringPlan:
    """States at the end of each interval, shape (N,) each."""

    found: bool
    across: FloatArray
    heading_error: FloatArray
    command: FloatArray
    cost: float
    slack: float
    """Largest distance outside the corridor [m]."""
    inputs: FloatArray


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
        self.program = Program(cost, rows, solver, tolerance)
        p = self.program
        p.G[: self._rows(self.STEER_LEFT).start, n] = -1.0
        p.lower[:n], p.upper[:n] = -max_rate, max_rate
        p.lower[n] = 0.0
        p.P[n, n] = 2.0 * weights.leaving
        p.q[n] = weights.leaving
        steering = self.horizon.steering_gain
        p.G[self._rows(self.STEER_LEFT), :n] = steering
        p.G[self._rows(self.STEER_RIGHT), :n] = -steering
        self._weights = np.empty((3, n))
        self._weights[0], self._weights[1] = weights.across * dt, weights.heading * dt
        self._rate_cost = np.diag(2.0 * weights.rate * dt)

    def build(self, task: SteeringTask) -> tuple[FloatArray, FloatArray]:
        """Write the task into the program and return the free response and the gains."""
        n, p = self.steps, self.program
        start = np.array([task.across, task.heading_error, task.steering, task.command])
        maps = self.horizon.maps(task.speed, task.curvature, start)
        free, gain = maps.free, maps.gain
        weights, errors = self._tracking(free, task)
        stacked = gain[:3].reshape(3 * n, n)
        weighted = stacked * (2.0 * weights).reshape(-1, 1)
        np.add(stacked.T @ weighted, self._rate_cost, out=p.P[:n, :n])
        p.q[:n] = errors.reshape(-1) @ weighted
        front_free = free[ACROSS] + self.front * free[HEADING]
        front_gain = gain[ACROSS] + self.front * gain[HEADING]
        # The rows of the steering angle's limits do not change.
        p.G[: 4 * n, :n].reshape(4, n, n)[:] = (gain[ACROSS], -gain[ACROSS], front_gain, -front_gain)
        p.h.reshape(6, n)[:] = (
            task.left - free[ACROSS],
            free[ACROSS] - task.right,
            task.left - front_free,
            front_free - task.right,
            self.max_steering - free[STEERING_COMMAND],
            self.max_steering + free[STEERING_COMMAND],
        )
        return free, gain

    def solve(self, task: SteeringTask, warm: FloatArray | None = None) -> SteeringPlan:
        """Return the plan for a task; ``found`` is False when the solver gave none."""
        free, gain = self.build(task)
        solution = self.program.solve(warm)
        n = self.steps
        states = free + gain @ solution.z[:n]
        return SteeringPlan(
            found=solution.found,
            across=states[ACROSS],
            heading_error=states[HEADING],
            command=states[STEERING_COMMAND],
            cost=solution.cost,
            slack=float(max(solution.z[n], 0.0)),
            inputs=solution.z,
        )

    def constant_cost(self, free: FloatArray, task: SteeringTask) -> float:
        """Return the part of the objective that no input changes, which the program leaves out."""
        weights, errors = self._tracking(free, task)
        return float((weights * errors**2).sum())

    def _tracking(self, free: FloatArray, task: SteeringTask) -> tuple[FloatArray, FloatArray]:
        """Return weights and errors of offset, heading and steering without input, shape (3, N) each."""
        w = self.weights
        # Lateral acceleration beyond the lane's own, as a weight on the steering angle.
        steering_weight = w.steering + w.lateral_acceleration * (task.speed**2 / self.wheelbase) ** 2
        self._weights[2] = steering_weight * self.dt
        follow = self.wheelbase * task.curvature
        return self._weights, np.stack([free[ACROSS] - task.target, free[HEADING], free[STEERING] - follow])

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)
