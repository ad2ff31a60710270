"""Sequential quadratic programs for the avoidance problem with given passing sides.

Each program linearises all margins about the plan so far and allows each of them to be violated at a price,
so that it always has a solution. The price of a cone is high enough that nothing is violated if the problem
has a solution (an exact penalty); otherwise, the result is a plan with little violation. A step is shortened
until the sum of the objective and the priced violations does not grow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.problem import blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solution import Solution
from controllers.optimisation.solve import Memory, Tally, solve
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem, gradients, margins

PRICE = 1e3
"""A violation v costs ``price (v + v^2 / 2)``, in units of the objective. The linear part makes the program
keep constraints that can be kept. The squares decide between violations where some are unavoidable; without
them the cost matrix would be singular, which OSQP copes with badly."""
END_PRICE = 100.0
"""Price of missing the end state: arriving late is better than hitting a pedestrian."""
FOLLOWER_PRICE = 10.0
"""Price of violating the gap to the vehicle behind, which can brake itself."""
UNITS = (1.0, 0.02)
"""Units of the input variables, which make them equally large for the solver [m/s, rad]."""
PAPER_SOLVER = SolverSettings("osqp", tolerance=1e-3)
SHARES = 0.5 ** np.arange(6)
"""Shares of a step that are tried."""
SETTLED = 1e-6
"""The iteration ends with a step smaller than this [m/s, rad]."""


@dataclass(frozen=True, slots=True)
class AvoidancePlan:
    """A plan and its value."""

    inputs: FloatArray
    """Shape (2, n) [m/s, rad]."""
    states: FloatArray
    """Shape (5, n + 1)."""
    cost: float
    """Objective J, without the price of violations."""
    merit: float
    """Objective and priced violations."""
    into_cones: float
    """Largest violation of a cone [m/s]."""
    violation: float
    """Largest violation of any margin but the follower's."""
    programs: int = 0
    """Number of quadratic programs that the plan took."""
    solved: bool = True
    """Whether the last of these programs was solved; if not, it has not improved the plan."""


def prices(steps: int) -> FloatArray:
    """Return the price of each of ``Margins.violations``, shape (n + 4,)."""
    result = np.full(steps + 4, PRICE)
    result[steps + 1], result[steps + 3] = FOLLOWER_PRICE, END_PRICE
    return result


def priced(violations: FloatArray, steps: int) -> FloatArray:
    """Return the price of violations, given as by ``Margins.violations`` along the last axis."""
    return np.asarray((violations + 0.5 * violations**2) @ prices(steps))


def merits(problem: AvoidanceProblem, inputs: FloatArray) -> FloatArray:
    """Return the sum of objective and priced violations, for inputs of shape (..., 2, n)."""
    short = margins(problem, problem.states(inputs)).violations(problem.steps)
    return np.asarray(problem.cost(inputs) + priced(short, problem.steps))


def valued(
    problem: AvoidanceProblem, inputs: FloatArray, programs: int = 0, solved: bool = True
) -> AvoidancePlan:
    """Return the plan that inputs lead to, with its value."""
    states, n = problem.states(inputs), problem.steps
    short = margins(problem, states).violations(n)
    cost = float(problem.cost(inputs))
    return AvoidancePlan(
        inputs=inputs,
        states=states,
        cost=cost,
        merit=cost + float(priced(short, n)),
        into_cones=float(short[:n].max()),
        violation=float(np.delete(short, n + 1).max()),
        programs=programs,
        solved=solved,
    )


class AvoidanceProgram:
    """Builds and solves the quadratic programs of problems of one size.

    Parameters
    ----------
    steps
        Number of steps n.
    people
        Number of pedestrians that fit in; rows of absent ones are inactive.
    steers, ends
        Whether the problems have steering inputs, and how many states they prescribe at the end.
    solver
        Settings of the solver.
    tally
        Counts the programs.
    """

    def __init__(
        self,
        steps: int,
        people: int,
        steers: bool,
        ends: int,
        solver: SolverSettings = PAPER_SOLVER,
        tally: Tally | None = None,
    ) -> None:
        self.steps, self.people, self.solver = steps, people, solver
        self._memory = Memory(tally or Tally())
        self.inputs = (2 if steers else 1) * steps
        sizes = (steps, steps, 6 * steps, 2 * ends)
        # One slack for the cones of each step, and one for each of the other blocks.
        slack_of = [np.tile(np.arange(steps), people)]
        slack_of += [np.full(size, steps + i) for i, size in enumerate(sizes)]
        slack = np.concatenate(slack_of)
        variables = {"change of speed [m/s]": steps}
        if steers:
            variables["change of wheel angle [0.02 rad]"] = steps
        variables |= {
            "into cones, by step [m/s]": steps,
            "too near ahead [m]": 1,
            "too near behind [m]": 1,
            "off the road, too fast or turning too fast": 1,
            "missing the end state": 1,
        }
        rows = {
            "relative velocity outside cones [m/s], softened": people * steps,
            "gap ahead [m], softened": steps,
            "gap behind [m], softened": steps,
            "edges, turn and speed, softened": 6 * steps,
            "end state, softened": 2 * ends,
        }
        p = self.problem = blank("sum (dv - dv_wanted)^2 + w ddelta^2 + priced violations", variables, rows)
        self._unit = np.repeat(UNITS, steps)[: self.inputs]
        p.P[range(self.inputs, len(p.q)), range(self.inputs, len(p.q))] = prices(steps)
        p.q[self.inputs :] = prices(steps)
        p.lower[self.inputs :] = 0.0
        p.G[np.arange(len(slack)), self.inputs + slack] = -1.0

    def build(self, problem: AvoidanceProblem, inputs: FloatArray) -> None:
        """Write the avoidance problem, linearised about a plan, into the quadratic one."""
        p, count = self.problem, self.inputs
        states = problem.states(inputs)
        value = np.concatenate(margins(problem, states).blocks())
        gradient = np.concatenate(gradients(problem, states).blocks())[:, :count]
        weights = np.repeat(problem.weights[:, 0], self.steps)[:count] * self._unit
        p.P[range(count), range(count)] = 2.0 * weights * self._unit
        p.q[:count] = -2.0 * weights * problem.wanted_inputs().ravel()[:count]
        present = len(problem.people) * self.steps
        absent = slice(present, self.people * self.steps)
        rows = np.delete(np.arange(len(p.h)), absent)
        p.G[rows, :count] = -gradient * self._unit
        p.h[rows] = value - gradient @ inputs.ravel()[:count]
        p.G[absent, :count] = 0.0
        p.h[absent] = np.inf
        low, high = problem.bounds()
        p.lower[:count] = low.ravel()[:count] / self._unit
        p.upper[:count] = high.ravel()[:count] / self._unit

    def step(self, problem: AvoidanceProblem, inputs: FloatArray) -> tuple[FloatArray, Solution]:
        """Return the plan after one program linearised about a given plan, and the program's solution."""
        self.build(problem, inputs)
        begin = np.zeros(len(self.problem.q))
        begin[: self.inputs] = inputs.ravel()[: self.inputs] / self._unit
        solution = solve(self.problem, self.solver, self._memory, begin)
        if not solution.solved:
            return inputs, solution
        found = np.zeros(2 * self.steps)
        found[: self.inputs] = solution.z[: self.inputs] * self._unit
        way = np.clip(found.reshape(2, -1), *problem.bounds()) - inputs
        tried = inputs + SHARES[:, None, None] * way
        # Take the longest step that does not make the plan worse; if all do, it cannot be improved.
        good = np.flatnonzero(merits(problem, tried) <= merits(problem, inputs) + 1e-12)
        return (tried[good[0]] if len(good) else inputs), solution

    def solve(self, problem: AvoidanceProblem, start: FloatArray, passes: int) -> AvoidancePlan:
        """Return the plan after at most ``passes`` programs.

        Parameters
        ----------
        problem
            Problem to solve; every pedestrian's ``side`` must be +1 or −1.
        start
            Plan to begin from, shape (2, n).
        passes
            Largest number of programs.
        """
        inputs = np.clip(start, *problem.bounds())
        count, solved = 0, True
        while count < passes:
            count += 1
            better, solution = self.step(problem, inputs)
            moved = float(np.abs(better - inputs).max())
            inputs, solved = better, solution.solved
            if not solved or moved < SETTLED:
                break
        return valued(problem, inputs, count, solved)
