"""Passing classes of the avoidance problem: whom the vehicle lets go first, and which class is cheapest.

With pedestrians sorted by when they enter the vehicle's path, the vehicle passes behind the first j and ahead
of the others: n + 1 classes instead of 2^n. Each class is a problem with one side per pedestrian. Plans that
change to one speed at once tell which classes are worth solving, and where to begin.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Tally
from controllers.velocity_obstacle.paper.cone_margins import clearances, cone_margins, nobody
from controllers.velocity_obstacle.paper.euler_bicycle import ACROSS, ALONG, HEADING, SPEED, SPEED_CHANGE
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem
from controllers.velocity_obstacle.paper.sequential_programs import (
    PAPER_SOLVER,
    PRICE,
    AvoidancePlan,
    AvoidanceProgram,
    merits,
)

JUMPS = 41
"""Number of speeds that are tried in plans that change to one speed at once."""
INTO_CONE = 0.1
"""A relative velocity farther inside a cone than this does not avoid the pedestrian [m/s]."""
INTO_DISC = 0.25
"""Share of a disc's radius by which a motion may enter the disc: plans graze discs, and vehicles do not
follow plans exactly."""
FEWEST_PLACES = 4
"""Number of pedestrians that the smallest program has room for; each larger one has twice as many."""


class Optimiser(Protocol):
    """Solves avoidance problems. It may keep a memory, so each ego needs its own."""

    @property
    def solver(self) -> SolverSettings | None:
        """The solver of its quadratic programs; ``None`` without any."""
        ...

    @property
    def tally(self) -> Tally:
        """Count of its quadratic programs."""
        ...

    def solve(self, problem: AvoidanceProblem, start: FloatArray | None) -> AvoidancePlan:
        """Return the best plan found.

        Parameters
        ----------
        problem
            Problem with pedestrians by time of entry; ``side`` is the one for passing ahead of each.
        start
            The last plan, moved to the present, shape (2, n); ``None`` without one.
        """
        ...


@dataclass(slots=True)
class QuadraticOptimiser:
    """Sequential quadratic programs for the most promising passing classes.

    Parameters
    ----------
    passes
        Largest number of programs per class.
    classes
        Largest number of classes solved.
    solver
        Settings of the solver.
    """

    passes: int = 5
    classes: int = 3
    solver: SolverSettings = PAPER_SOLVER
    tally: Tally = field(default_factory=Tally)
    _programs: dict[tuple[int, int, bool, int], AvoidanceProgram] = field(default_factory=dict)

    def solve(self, problem: AvoidanceProblem, start: FloatArray | None) -> AvoidancePlan:
        """Return the plan of the cheapest class."""
        scores, jumps = class_jumps(problem)
        best: AvoidancePlan | None = None
        for behind in np.argsort(scores, kind="stable")[: self.classes]:
            plan = self.solve_class(problem, int(behind), jumps[behind], start)
            if best is None or _rank(plan) < _rank(best):
                best = plan
        assert best is not None  # there is always the class that lets nobody go first
        return best

    def solve_class(
        self, problem: AvoidanceProblem, behind: int, *starts: FloatArray | None
    ) -> AvoidancePlan:
        """Return the plan of one class, starting from the best of some plans.

        With steering, the wanted inputs are a second start: a vehicle that stands cannot be steered, so no
        step leads away from a plan that stops.
        """
        one = of_class(problem, behind)
        wanted = np.clip(one.wanted_inputs(), *one.bounds())
        begin = np.stack([wanted, *(np.clip(start, *one.bounds()) for start in starts if start is not None)])
        first = begin[int(np.argmin(merits(one, begin)))]
        program = self.program(one)
        best = program.solve(one, first, self.passes)
        if one.steers and first is not begin[0]:
            other = program.solve(one, wanted, self.passes)
            best = min(best, other, key=_rank)
        return best

    def program(self, problem: AvoidanceProblem) -> AvoidanceProgram:
        """Return the program that a problem of this size fits into; each is made once."""
        places = FEWEST_PLACES
        while places < len(problem.people):
            places *= 2
        ends = len(problem.end.targets()) if problem.end is not None else 0
        size = (problem.steps, places, problem.steers, ends)
        if size not in self._programs:
            self._programs[size] = AvoidanceProgram(*size, self.solver, self.tally)
        return self._programs[size]


def _rank(plan: AvoidancePlan) -> tuple[bool, float]:
    """Return the sort key of a plan: solved plans come before unsolved ones."""
    return not plan.solved, plan.merit


def of_class(problem: AvoidanceProblem, behind: int) -> AvoidanceProblem:
    """Return the problem in which the vehicle passes behind the first ``behind`` pedestrians."""
    ahead = np.arange(len(problem.people)) >= behind
    side = np.where(ahead, problem.people.side, -problem.people.side)
    return problem.passed(side)


def passed_behind(problem: AvoidanceProblem, states: FloatArray) -> BoolArray:
    """Return whom a motion passes behind, shape (m,): those whose cone it is farther out of on that side."""
    ahead = cone_margins(problem.cone, problem.people, states, problem.reference_point)
    other = problem.passed(-problem.people.side).people
    behind = cone_margins(problem.cone, other, states, problem.reference_point)
    shape = (len(problem.people), problem.steps)
    inside = [np.minimum(one.reshape(shape), 0.0).sum(axis=1) for one in (ahead, behind)]
    return np.asarray(inside[1] > inside[0])


def not_avoided(problem: AvoidanceProblem, states: FloatArray) -> BoolArray:
    """Return whose cone or disc a motion enters by more than the tolerances, shape (m,)."""
    people, point = problem.people, problem.reference_point
    either = problem.passed(np.zeros(len(people))).people
    margin = cone_margins(problem.cone, either, states, point).reshape(len(people), problem.steps)
    # Within the disc the margin is a depth, so the clearance decides there.
    x = people.along - states[ALONG, 1:] - point * np.cos(states[HEADING, 1:])
    y = people.across - states[ACROSS, 1:] - point * np.sin(states[HEADING, 1:])
    entered = ((margin < -INTO_CONE) & (np.hypot(x, y) > people.radius)).any(axis=1)
    clearance = clearances(people, states, problem.bicycle.step, point)
    return np.asarray(entered | (clearance < -INTO_DISC * people.radius[:, 0]))


def class_jumps(problem: AvoidanceProblem) -> tuple[FloatArray, FloatArray]:
    """Return, for every class, the merit of the best plan that changes to one speed at once, and that plan.

    With a cone at every step, the least change is often exactly such a plan. Shapes (m + 1,) and
    (m + 1, 2, n). The cones' violations are summed here without their squares: the merit is only for choosing
    where to begin.
    """
    n, people = problem.steps, problem.people
    plans = np.zeros((JUMPS, 2, n))
    speed = float(problem.start[SPEED])
    plans[:, SPEED_CHANGE, 0] = np.linspace(0.0, problem.top_speed(), JUMPS) - speed
    plans = np.concatenate((np.zeros((1, 2, n)), plans))
    plans = np.clip(plans, *problem.bounds())
    states = problem.states(plans)
    base = merits(replace(problem, people=nobody(n)), plans)
    short = [
        np.maximum(
            -cone_margins(
                problem.cone, replace(people, side=sign * people.side), states, problem.reference_point
            ),
            0.0,
        )
        .reshape(len(plans), -1, n)
        .sum(axis=-1)
        for sign in (1.0, -1.0)
    ]
    begun = np.zeros((len(plans), 1))
    ahead = np.concatenate((np.cumsum(short[0][:, ::-1], axis=1)[:, ::-1], begun), axis=1)
    behind = np.concatenate((begun, np.cumsum(short[1], axis=1)), axis=1)
    merit = base[:, None] + PRICE * (ahead + behind)
    chosen = np.argmin(merit, axis=0)
    return merit[chosen, np.arange(len(chosen))], plans[chosen]
