"""A genetic algorithm for the avoidance problem: the velocity-obstacle paper's own kind of solver.

Individuals are the inputs themselves (real-coded). Of two individuals, the one with less violation wins, then
the one with less cost. No passing side is given: at each step, the better side counts.
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
"""Price of missing the end state by one, in units of the objective: random search does not meet equations."""
CROWD, ROUNDS = 12, 3
"""Number of pedestrians that each search adds at most, and largest number of searches."""
CROWDING = 2.0
"""The first generation is the wanted inputs plus draws from the bounds times u^CROWDING, with u uniform: 0
fills the bounds evenly, and larger values crowd the individuals about the wanted inputs."""


@dataclass(frozen=True, slots=True)
class GeneticBudget:
    """Effort of one solve, which evaluates generations times population plans."""

    generations: int
    population: int


@dataclass(slots=True)
class GeneticOptimiser:
    """Solves one problem after another with random numbers of its own.

    Parameters
    ----------
    budget
        Effort per problem.
    seed
        Seed of all random numbers.
    """

    budget: GeneticBudget
    seed: int
    solver: SolverSettings | None = None
    tally: Tally = field(default_factory=Tally)
    """Stays empty, as no programs are solved."""
    _drawn: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._drawn = np.random.default_rng(self.seed)

    def solve(self, problem: AvoidanceProblem, start: FloatArray | None) -> AvoidancePlan:
        """Return the best plan found; see ``passing_classes.Optimiser``.

        In a crowd, the first search considers the pedestrians whose cones the wanted inputs enter deepest.
        Each further search, up to ``ROUNDS`` in all, adds those whose cones the last plan enters.
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
        Problem to solve; the pedestrians' sides are not used.
    budget
        The search stops after its number of generations, however long they take.
    seed
        Seed of all random numbers.
    start
        A plan for the first generation, in addition to the wanted inputs, shape (2, n).

    Notes
    -----
    [VOMPC2019]_ says only that it uses a genetic algorithm.
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
    """Return one plan's least margin for each pedestrian, shape (m,) [m/s]."""
    people = margins(problem, problem.states(inputs)).people
    return np.asarray(people.reshape(len(problem.people), problem.steps).min(axis=1))


def valued_for_search(problem: AvoidanceProblem, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the cost of plans and the sum of their violations; inputs of shape (..., 2, n).

    The cost includes prices for missing the end state and the follower's gap. Cones, the gap ahead and the
    road have no price: only they count as violations.
    """
    found = margins(problem, problem.states(inputs))
    short = sum(
        (np.maximum(-block, 0.0).sum(axis=-1) for block in (found.people, found.ahead, found.road)),
        start=np.zeros(inputs.shape[:-2]),
    )
    missed = MISSED_PRICE * np.maximum(-found.end, 0.0).sum(axis=-1)
    pushed = FOLLOWER_PRICE * np.maximum(-found.behind, 0.0).max(axis=-1)
    return np.asarray(problem.cost(inputs) + missed + pushed), np.asarray(short)
