"""The same plan by pymoo's genetic algorithm: our condensed programs, their soft rows as penalties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from controllers.optimisation.problem import Problem as Quadratic
from measuring.tasks import Planner, Step

FloatArray = NDArray[np.float64]

POPULATION, GENERATIONS = 50, 100
HARD = 1e3
"""Penalty of a violated row that the programs keep hard, per squared unit."""


@dataclass(frozen=True, slots=True)
class Penalised:
    """A program over its inputs alone: the best slacks follow from them."""

    program: Quadratic
    inputs: int

    def cost(self, z: FloatArray) -> FloatArray:
        """Return the objective of many inputs, shape (many, n) to (many,)."""
        p, n = self.program, self.inputs
        over = z @ p.G[:, :n].T - p.h
        total = np.einsum("ij,ij->i", z @ (0.5 * p.P[:n, :n]), z) + z @ p.q[:n]
        hard = np.ones(len(p.h), dtype=bool)
        for j in range(n, len(p.q)):
            soft = p.G[:, j] < 0.0
            hard &= ~soft
            needed = (over[:, soft] / -p.G[soft, j]).max(axis=1)
            slack = np.clip(needed, 0.0, p.upper[j])
            total += 0.5 * p.P[j, j] * slack**2 + p.q[j] * slack
            total += HARD * (needed - slack).clip(0.0) ** 2
        return np.asarray(total + HARD * (over[:, hard].clip(0.0) ** 2).sum(axis=1))


class _Both(Problem):  # type: ignore[misc]
    """Speed and steering at once, evaluated for a whole population."""

    def __init__(self, speed: Penalised, steering: Penalised, low: FloatArray, high: FloatArray) -> None:
        super().__init__(n_var=len(low), n_obj=1, xl=low, xu=high)
        self._speed, self._steering = speed, steering

    def _evaluate(self, x: FloatArray, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        n = self._speed.inputs
        out["F"] = (self._speed.cost(x[:, :n]) + self._steering.cost(x[:, n:]))[:, None]


@dataclass(slots=True)
class GeneticPlanner:
    """Plans one step after the other; the programs are built as the controller builds them."""

    programs: Planner

    def plan(self, step: Step) -> tuple[float, FloatArray]:
        """Return the least cost found, without constants, and the inputs."""
        problem = self._problem(step)
        answer = minimize(problem, GA(pop_size=POPULATION), ("n_gen", GENERATIONS), seed=1, verbose=False)
        return float(answer.F[0]), np.asarray(answer.X)

    def cost_of(self, step: Step, speed: FloatArray, steering: FloatArray) -> float:
        """Return the same cost of given inputs."""
        n = self.programs.speed.steps
        out: dict[str, Any] = {}
        self._problem(step)._evaluate(np.concatenate((speed[:n], steering[:n]))[None, :], out)
        return float(out["F"][0, 0])

    def _problem(self, step: Step) -> _Both:
        speed, steering = self.programs.speed, self.programs.steering
        n = speed.steps
        speed.build(step.speed)
        steering.build(step.steering)
        hardest = -speed.limits.emergency_braking - step.speed.command
        low = np.concatenate((np.full(n, min(hardest, 0.0)), steering.problem.lower[:n]))
        high = np.concatenate((speed.problem.upper[:n] + 1e-3, steering.problem.upper[:n]))
        return _Both(Penalised(speed.problem, n), Penalised(steering.problem, n), low, high)
