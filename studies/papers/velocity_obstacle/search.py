"""Compares the genetic algorithm, with many seeds, to the programs on the velocity-obstacle experiments."""

from __future__ import annotations

from dataclasses import dataclass
from time import process_time

import numpy as np

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.paper.genetic_algorithm import GeneticBudget, solve_genetically
from controllers.velocity_obstacle.paper.passing_classes import QuadraticOptimiser
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem
from controllers.velocity_obstacle.paper.sequential_programs import AvoidancePlan

QUICKER = 1.0 / 3.0
REPEATED = 3
"""The programs' time is the smallest of this many repeats."""
SEEDS = range(1, 21)
KEPT = 0.12
"""A plan of the genetic algorithm counts as feasible if it violates constraints by no more than this: at the
end of a lane change, 0.12 m or 0.7 degrees."""


@dataclass(frozen=True, slots=True)
class Spread:
    """Results of the genetic algorithm with different seeds, and of the quadratic programs."""

    budget: GeneticBudget
    plans: tuple[AvoidancePlan, ...]
    best: AvoidancePlan
    """Best plan of the quadratic programs."""
    quicker: bool
    """Whether the programs needed less than ``QUICKER`` of the mean time of a search."""

    @property
    def costs(self) -> FloatArray:
        """Objective of each seed's plan."""
        return np.array([plan.cost for plan in self.plans])

    @property
    def gaps(self) -> FloatArray:
        """Excess of each seed's objective over the optimum, as a share."""
        return self.costs / self.best.cost - 1.0

    @property
    def feasible(self) -> int:
        """Number of plans that keep the constraints."""
        return sum(plan.violation <= KEPT for plan in self.plans)

    @property
    def variations(self) -> FloatArray:
        """Total variation of the wheel angle for each seed [rad]."""
        return np.array([variation(plan) for plan in self.plans])


def variation(plan: AvoidancePlan) -> float:
    """Return the total variation of the wheel angle, the sum of |ddelta| [rad]."""
    return float(np.abs(plan.inputs[1]).sum())


def spread(problem: AvoidanceProblem, budget: GeneticBudget, optimiser: QuadraticOptimiser) -> Spread:
    """Solve a problem genetically with all seeds, and with sequential quadratic programs.

    Parameters
    ----------
    problem : problem with one pedestrian, whose side is that of passing ahead
    budget : budget of each search
    optimiser : optimiser that solves the programs
    """
    # The first calls also build and load what is needed only once.
    best = optimiser.solve(problem, None)
    solve_genetically(problem, GeneticBudget(1, 4), 0)
    times = []
    for _ in range(REPEATED):
        begun = process_time()
        optimiser.solve(problem, None)
        times.append(process_time() - begun)
    begun = process_time()
    plans = tuple(solve_genetically(problem, budget, seed) for seed in SEEDS)
    search = (process_time() - begun) / len(SEEDS)
    return Spread(budget, plans, best, min(times) < QUICKER * search)
