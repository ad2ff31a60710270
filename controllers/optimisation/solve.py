"""Solving a quadratic program with any solver that qpsolvers knows.

A solver's word is not enough: what it gives is used only when its certificate holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import qpsolvers
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from controllers.optimisation.problem import Problem
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solution import Solution, certify, unsolved
from controllers.optimisation.warm_osqp import WARM_OSQP, Workspace

FloatArray = NDArray[np.float64]

OSQP = "osqp"
REFINED = 4
"""How many more digits OSQP is asked for, one after the other, while a certificate does not hold."""
_FAILURES = (ValueError, ArithmeticError, RuntimeError, qpsolvers.QPError)
"""What solvers raise instead of saying that they found nothing."""


@dataclass(slots=True)
class Tally:
    """How many programs there were, and how many of them were left without a solution."""

    programs: int = 0
    unsolved: int = 0

    def take(self) -> tuple[int, int]:
        """Return both, and begin to count anew."""
        counted = self.programs, self.unsolved
        self.programs = self.unsolved = 0
        return counted


@dataclass(slots=True)
class Memory:
    """What one solve leaves for the next one of the same ego."""

    tally: Tally = field(default_factory=Tally)
    workspace: Workspace | None = None
    """OSQP's."""


def solve(
    problem: Problem,
    settings: SolverSettings,
    memory: Memory | None = None,
    start: FloatArray | None = None,
) -> Solution:
    """Solve a problem; never raises, ``solved`` says whether the result may be used.

    Parameters
    ----------
    problem
        As it stands.
    settings
        Which solver.
    memory
        Of an ego that solves one problem of this shape after the other; ``None`` begins anew.
    start
        Where OSQP begins, shape (n,); ``None`` for where it ended.
    """
    memory = Memory() if memory is None else memory
    solution = _solve(problem, settings, memory, start)
    memory.tally.programs += 1
    if not solution.solved:
        memory.tally.unsolved += 1
        memory.workspace = None  # what led nowhere is no place to begin from
    return solution


def _solve(problem: Problem, settings: SolverSettings, memory: Memory, start: FloatArray | None) -> Solution:
    # NaN in a warm workspace spoils the solves after it, and some solvers report success on NaN.
    if not problem.is_finite():
        return unsolved(problem, "the problem holds values that are no numbers")
    if settings.name != OSQP:
        return _by_name(problem, settings)
    solution = _by_warm_osqp(problem, memory, start, settings.tolerance)
    for digits in range(1, REFINED + 1):
        if solution.solved:
            break
        # OSQP stops at residuals that are small beside the largest numbers of the problem. It goes on from
        # where it has come to.
        solution = _by_warm_osqp(problem, memory, None, settings.tolerance * 0.1**digits)
    return solution


def _by_name(problem: Problem, settings: SolverSettings) -> Solution:
    """Solve it without the rows that bound nothing, matrices dense or sparse as the solver wants them."""
    rows = np.flatnonzero(np.isfinite(problem.h))
    sparse = settings.name not in qpsolvers.dense_solvers
    P, G = (csc_matrix(one) if sparse else one for one in (problem.P, problem.G[rows]))
    given = qpsolvers.Problem(
        P,
        problem.q,
        G if len(rows) else None,
        problem.h[rows] if len(rows) else None,
        lb=problem.lower,
        ub=problem.upper,
    )
    return _certified(problem, rows, given, settings.name)


def _by_warm_osqp(problem: Problem, memory: Memory, start: FloatArray | None, tolerance: float) -> Solution:
    if memory.workspace is None:
        memory.workspace = Workspace()
    rows = np.arange(len(problem.h))
    given = qpsolvers.Problem(problem.P, problem.q, problem.G, problem.h, lb=problem.lower, ub=problem.upper)
    return _certified(
        problem, rows, given, WARM_OSQP, initvals=start, workspace=memory.workspace, tolerance=tolerance
    )


def _certified(
    problem: Problem, rows: NDArray[np.intp], given: qpsolvers.Problem, solver: str, **options: Any
) -> Solution:
    """Have a solver solve what it is given, which are some rows of a problem, and check what it says."""
    try:
        answer = qpsolvers.solve_problem(given, solver, **options)
    except _FAILURES as error:
        return unsolved(problem, f"{solver} raised {type(error).__name__}")
    if not answer.found or answer.x is None or not np.isfinite(answer.x).all():
        return unsolved(problem, f"{solver} found nothing")
    multipliers, box = np.zeros(len(problem.h)), np.zeros(len(problem.q))
    if answer.z is not None:
        multipliers[rows] = answer.z
    if answer.z_box is not None and len(answer.z_box):
        box[:] = answer.z_box
    return certify(problem, np.asarray(answer.x, dtype=np.float64), multipliers, box)
