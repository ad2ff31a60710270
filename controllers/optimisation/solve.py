"""Solving a quadratic program with any solver that qpsolvers knows.

The answer of a solver is not taken on trust: it is used only if its certificate holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import qpsolvers
from scipy.sparse import csc_matrix

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solution import Rows, Solution, certify, unsolved
from controllers.optimisation.warm_osqp import WARM_OSQP, Workspace

OSQP = "osqp"
REFINED = 4
"""How many times OSQP is asked for one more digit while the certificate does not hold."""
_FAILURES = (ValueError, ArithmeticError, RuntimeError, qpsolvers.QPError)
"""Errors that solvers raise instead of reporting that they found nothing."""


@dataclass(slots=True)
class Tally:
    """Number of programs, and how many of them were left without a solution."""

    programs: int = 0
    unsolved: int = 0

    def take(self) -> tuple[int, int]:
        """Return both numbers, and start counting again."""
        counted = self.programs, self.unsolved
        self.programs = self.unsolved = 0
        return counted


@dataclass(slots=True)
class Memory:
    """What one solve leaves for the next one of the same ego."""

    tally: Tally = field(default_factory=Tally)
    workspace: Workspace | None = None
    """Workspace of OSQP."""


def solve(
    problem: Problem,
    settings: SolverSettings,
    memory: Memory | None = None,
    start: FloatArray | None = None,
) -> Solution:
    """Solve a problem. This never raises; ``solved`` says whether the result may be used.

    Parameters
    ----------
    problem
        The problem, with its present values.
    settings
        Choice of solver.
    memory
        Memory of an ego that solves one problem of this shape after another; ``None`` starts afresh.
    start
        Point at which OSQP starts, shape (n,); ``None`` for where it ended last.
    """
    memory = Memory() if memory is None else memory
    solution = _solve(problem, settings, memory, start)
    memory.tally.programs += 1
    if not solution.solved:
        memory.tally.unsolved += 1
        memory.workspace = None  # a failed solve is no good start for the next one
    return solution


def _solve(problem: Problem, settings: SolverSettings, memory: Memory, start: FloatArray | None) -> Solution:
    # Bounds that are NaN stay in, so that the certificate fails on them.
    rows = (problem.h != np.inf).nonzero()[0]
    bounded = Rows(rows, problem.G.take(rows, axis=0), problem.h.take(rows))
    if settings.name != OSQP:
        return _by_name(problem, bounded, settings.name)
    solution = _by_warm_osqp(problem, bounded, memory, start, settings.tolerance)
    for digits in range(1, REFINED + 1):
        if solution.solved:
            break
        # OSQP stops at residuals that are small relative to the largest numbers of the problem. It continues
        # from the point that it has reached.
        solution = _by_warm_osqp(problem, bounded, memory, None, settings.tolerance * 0.1**digits)
    return solution


def _by_name(problem: Problem, rows: Rows, solver: str) -> Solution:
    """Solve the problem without unbounded rows, with dense or sparse matrices as the solver requires."""
    dense = solver in qpsolvers.dense_solvers
    given = qpsolvers.Problem(
        problem.P if dense else csc_matrix(problem.P),
        problem.q,
        (rows.G if dense else csc_matrix(rows.G)) if len(rows.h) else None,
        rows.h if len(rows.h) else None,
        lb=problem.lower,
        ub=problem.upper,
    )
    try:
        answer = qpsolvers.solve_problem(given, solver)
    except _FAILURES as error:
        return unsolved(problem, f"{solver} raised {type(error).__name__}")
    return _certified(problem, rows, solver, answer, answer.z)


def _by_warm_osqp(
    problem: Problem, rows: Rows, memory: Memory, start: FloatArray | None, tolerance: float
) -> Solution:
    """Solve the problem with all rows, which keeps the sparsity pattern."""
    if memory.workspace is None:
        memory.workspace = Workspace()
    given = qpsolvers.Problem(
        problem.P, problem.q, problem.G, problem.h, None, None, problem.lower, problem.upper
    )
    try:
        answer = qpsolvers.solve_problem(
            given, WARM_OSQP, initvals=start, workspace=memory.workspace, tolerance=tolerance
        )
    except _FAILURES as error:
        return unsolved(problem, f"{OSQP} raised {type(error).__name__}")
    return _certified(problem, rows, OSQP, answer, None if answer.z is None else answer.z[rows.numbers])


def _certified(
    problem: Problem, rows: Rows, solver: str, answer: qpsolvers.Solution, multipliers: FloatArray | None
) -> Solution:
    """Return the certified answer of a solver; multipliers that it does not give count as 0."""
    if not answer.found or answer.x is None:
        return unsolved(problem, f"{solver} found nothing")
    y = np.zeros(len(rows.h)) if multipliers is None else multipliers
    box = answer.z_box
    if box is None or not len(box):
        box = np.zeros(len(problem.q))
    return certify(problem, rows, answer.x, y, box)
