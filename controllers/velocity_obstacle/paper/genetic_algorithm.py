"""A genetic algorithm for the avoidance problem: the velocity-obstacle paper's own kind of solver.

Individuals are the inputs themselves (real-coded). Of two, the one that violates less wins, then the one
that costs less. No passing side is given: at each step the better one counts.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Tally
from controllers.velocity_obstacle.paper.genetic_search import search
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem, margins
from controllers.velocity_obstacle.paper.sequential_programs import FOLLOWER_PRICE, AvoidancePlan, valued

MISSED_PRICE = 10.0
"""Of missing the end state by one, in units of the objective: a random search does not meet equations."""
CROWD, ROUNDS = 12, 3
"""Pedestrians that one search minds at first and that each further one adds, and searches at most."""
CROWDING = 2.0
"""Individuals of the first generation are drawn from the bounds times u^CROWDING, u uniform: with 0 they
fill the bounds evenly, with more they crowd about doing nothing."""


@dataclass(frozen=True, slots=True)
class GeneticBudget:
    """What one solve costs: generations times population plans are valued."""

    generations: int
    population: int


@dataclass(slots=True)
class GeneticOptimiser:
    """Solves one problem after the other with random numbers of its own.

    Parameters
    ----------
    budget
        Per problem.
    seed
        Of all random numbers.
    """

    budget: GeneticBudget
    seed: int
    solver: SolverSettings | None = None
    tally: Tally = field(default_factory=Tally)
    """It solves no programs."""
    _drawn: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._drawn = np.random.default_rng(self.seed)

    def solve(self, problem: AvoidanceProblem, start: FloatArray | None) -> AvoidancePlan:
        """Return the best plan found; see ``passing_classes.Optimiser``.

        Of a crowd, those are minded first whose cones doing what is wanted enters deepest; whose cones the
        plan then enters are added, and it is searched again, at most ``ROUNDS`` times in all.
        """
        everybody = problem.passed(np.zeros(len(problem.people)))
        inputs = np.clip(problem.wanted_inputs(), *problem.bounds())
        chosen = np.zeros(len(problem.people), dtype=bool)
        for _ in range(ROUNDS):
            depth = np.where(chosen, np.inf, _margin(everybody, inputs))
            added = np.argsort(depth, kind="stable")[:CROWD]
            if chosen.any():
                added = added[depth[added] < 0.0]
                if not len(added):
                    break
            chosen[added] = True
            some = replace(everybody, people=everybody.people.only(np.flatnonzero(chosen)))
            seed = int(self._drawn.integers(2**31))
            inputs = solve_genetically(some, self.budget, seed, start).inputs
            if chosen.all():
                break
        return valued(everybody, inputs)


def solve_genetically(
    problem: AvoidanceProblem, budget: GeneticBudget, seed: int, start: FloatArray | None = None
) -> AvoidancePlan:
    """Return the best plan that a genetic algorithm finds.

    Parameters
    ----------
    problem
        What to solve; the pedestrians' sides are not used.
    budget
        It stops after so many generations; the clock does not matter.
    seed
        Of all random numbers.
    start
        A plan for the first generation, shape (2, n), beside doing what is wanted.

    Notes
    -----
    [VOMPC2019]_ says no more than that it uses a genetic algorithm.
    """
    either = problem.passed(np.zeros(len(problem.people)))
    low, high = problem.bounds()
    free = high > low
    wanted = np.clip(problem.wanted_inputs(), low, high)

    def inputs_of(genes: FloatArray) -> FloatArray:
        inputs = np.broadcast_to(wanted, (len(genes), *wanted.shape)).copy()
        inputs[:, free] = genes
        return inputs

    drawn = np.random.default_rng(seed)
    shares = drawn.uniform(0.0, 1.0, (budget.population, 1)) ** CROWDING
    first = wanted[free] + shares * (drawn.uniform(low[free], high[free], (budget.population, free.sum())))
    first = np.clip(first, low[free], high[free])
    first[0] = wanted[free]
    if start is not None:
        first[1] = np.clip(start, low, high)[free]

    def value(genes: FloatArray) -> tuple[FloatArray, FloatArray]:
        return valued_for_search(either, inputs_of(genes))

    last = search(first, value, low[free], high[free], budget.generations, seed)
    return valued(either, inputs_of(last[:1])[0])


def _margin(problem: AvoidanceProblem, inputs: FloatArray) -> FloatArray:
    """Return the least margin of one plan for each pedestrian, shape (m,) [m/s]."""
    people = margins(problem, problem.states(inputs)).people
    return np.asarray(people.reshape(len(problem.people), problem.steps).min(axis=1))


def valued_for_search(problem: AvoidanceProblem, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return what plans cost and the sum of what they violate; inputs of shape (..., 2, n).

    The end and the follower's gap are priced in the cost; cones, the gap ahead and the road are not for
    sale.
    """
    found = margins(problem, problem.states(inputs))
    short = sum(
        (np.maximum(-block, 0.0).sum(axis=-1) for block in (found.people, found.ahead, found.road)),
        start=np.zeros(inputs.shape[:-2]),
    )
    missed = MISSED_PRICE * np.maximum(-found.end, 0.0).sum(axis=-1)
    pushed = FOLLOWER_PRICE * np.maximum(-found.behind, 0.0).max(axis=-1)
    return np.asarray(problem.cost(inputs) + missed + pushed), np.asarray(short)
