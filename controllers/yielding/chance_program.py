"""The speed plan of the chance-constrained controller: a quadratic program over accelerations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory, solve

AHEAD, BEYOND, SLOW = (
    "position before whom the ego lets pass, softened",
    "position beyond whom it goes ahead of, softened",
    "speed not negative",
)


@dataclass(frozen=True, slots=True)
class ChanceWeights:
    """Weights of the objective, per second of horizon."""

    speed: float = 0.3
    """[1/(m/s)^2]"""
    acceleration: float = 1.0
    """[1/(m/s^2)^2]"""
    change: float = 0.6
    """Weight of the change of acceleration [1/(m/s^3)^2]."""
    violation: float = 300.0
    """Weight of the squared violation of a position bound, not multiplied by time [1/m^2]."""


@dataclass(frozen=True, slots=True)
class ChancePlan:
    """A planned motion; shape (K,) each."""

    solved: bool
    cost: float
    acceleration: FloatArray
    position: FloatArray
    speed: FloatArray
    slack: float
    """[m]"""


class ChanceProgram:
    """The program for a fixed horizon; it is set up anew for each solve.

    Parameters
    ----------
    step, count : length of a step [s] and number K of steps of the horizon
    weights : weights of the objective
    hardest : greatest deceleration [m/s^2]
    solver : settings of the solver
    """

    def __init__(
        self, step: float, count: int, weights: ChanceWeights, hardest: float, solver: SolverSettings
    ) -> None:
        self.times = step * np.arange(1.0, count + 1.0)
        self._step, self._weights, self._hardest = step, weights, hardest
        self._solver, self.memory = solver, Memory()
        # Constant accelerations over the steps: v = v0 + S a, x = v0 t + T a.
        lower = np.tril(np.ones((count, count)))
        self._to_speed = step * lower
        each = (np.arange(count)[:, None] - np.arange(count)[None, :] + 0.5) * lower
        self._to_position = step**2 * each
        change = (np.eye(count) - np.eye(count, k=-1)) / step
        w, dt = weights, step
        self._quadratic = dt * (
            w.speed * self._to_speed.T @ self._to_speed
            + w.acceleration * np.eye(count)
            + w.change * change.T @ change
        )
        self._change = change

    def problem(
        self,
        speed: float,
        before: float,
        wanted: FloatArray,
        upper: FloatArray,
        lower: FloatArray,
        acceleration: float,
    ) -> Problem:
        """Return the program, not solved yet.

        Parameters
        ----------
        speed, before : present speed [m/s] and acceleration [m/s^2]
        wanted : speeds to drive, shape (K,) [m/s]
        upper, lower : bounds of the position from now; infinite where there is none, shape (K,) [m]
        acceleration : greatest acceleration [m/s^2]
        """
        count, w, dt = len(self.times), self._weights, self._step
        sizes = {"acceleration [m/s^2]": count, "slack [m]": 2}
        problem = blank(
            "sum dt [w_v (v - wanted)^2 + w_a a^2 + w_j j^2] + w slack^2",
            sizes,
            {AHEAD: count, BEYOND: count, SLOW: count},
        )
        problem.P[:count, :count] = 2.0 * self._quadratic
        problem.P[count, count] = problem.P[count + 1, count + 1] = 2.0 * w.violation
        first = np.zeros(count)
        first[0] = before / dt
        problem.q[:count] = (
            -2.0 * dt * (w.speed * self._to_speed.T @ (wanted - speed) + w.change * self._change.T @ first)
        )
        free = speed * self.times
        problem.G[:count, :count], problem.G[:count, count] = self._to_position, -1.0
        problem.h[:count] = upper - free
        problem.G[count : 2 * count, :count] = -self._to_position
        problem.G[count : 2 * count, count + 1] = -1.0
        problem.h[count : 2 * count] = free - lower
        problem.G[2 * count :, :count] = -self._to_speed
        problem.h[2 * count :] = speed
        problem.lower[:count], problem.upper[:count] = -self._hardest, acceleration
        problem.lower[count:] = 0.0
        return problem

    def solve(self, problem: Problem, speed: float, before: float, wanted: FloatArray) -> ChancePlan:
        """Return the plan that solves a program; for the other parameters see ``problem``."""
        count, w = len(self.times), self._weights
        found = solve(problem, self._solver, self.memory)
        accelerations, slack = found.z[:count], found.z[count:]
        speeds = speed + self._to_speed @ accelerations
        changes = self._change @ accelerations
        changes[0] -= before / self._step
        squares = w.speed * (speeds - wanted) ** 2 + w.acceleration * accelerations**2 + w.change * changes**2
        return ChancePlan(
            found.solved,
            float(self._step * squares.sum() + w.violation * (slack**2).sum()),
            accelerations,
            speed * self.times + self._to_position @ accelerations,
            speeds,
            float(max(slack.max(), 0.0)),
        )
