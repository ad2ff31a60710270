"""The genetic algorithm on the velocity-obstacle paper's experiments, with many seeds and the programs."""

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
"""The programs' time is the least of so many."""
SEEDS = range(1, 21)
KEPT = 0.12
"""A plan of the genetic algorithm that misses constraints by no more counts: 0.12 m at the end of a lane
change, or 0.7 degrees there."""


@dataclass(frozen=True, slots=True)
class Spread:
    """What the genetic algorithm found with different seeds, and what the programs did."""

    budget: GeneticBudget
    plans: tuple[AvoidancePlan, ...]
    best: AvoidancePlan
    """Of the quadratic programs."""
    quicker: bool
    """Whether those needed less than ``QUICKER`` of the mean time of a search."""

    @property
    def costs(self) -> FloatArray:
        """Objective for each seed."""
        return np.array([plan.cost for plan in self.plans])

    @property
    def gaps(self) -> FloatArray:
        """How much more each costs than the optimum, as a share."""
        return self.costs / self.best.cost - 1.0

    @property
    def feasible(self) -> int:
        """How many of them keep the constraints."""
        return sum(plan.violation <= KEPT for plan in self.plans)

    @property
    def variations(self) -> FloatArray:
        """Total variation of the wheel angle for each seed [rad]."""
        return np.array([variation(plan) for plan in self.plans])


def variation(plan: AvoidancePlan) -> float:
    """Return the total variation of the wheel angle, the sum of |ddelta| [rad]."""
    return float(np.abs(plan.inputs[1]).sum())


def spread(problem: AvoidanceProblem, budget: GeneticBudget, optimiser: QuadraticOptimiser) -> Spread:
    """Solve a problem with all seeds, and with sequential quadratic programs.

    Parameters
    ----------
    problem : one pedestrian, its side that of passing ahead
    budget : of each search
    optimiser : of the programs
    """
    # The first calls build and load what is needed once.
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
