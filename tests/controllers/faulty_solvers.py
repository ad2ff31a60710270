"""Solvers that fail, or that call rubbish optimal, under names of their own in qpsolvers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import qpsolvers

SMALL = 0.01
"""Multipliers below this share of the largest term of the objective: a certificate does without them."""
Answer = Callable[[qpsolvers.Problem], qpsolvers.Solution]


def installed(monkeypatch: pytest.MonkeyPatch, name: str, answer: Answer) -> str:
    """Have qpsolvers know a solver for the length of a test."""

    def solve(problem: qpsolvers.Problem, **_: object) -> qpsolvers.Solution:
        return answer(problem)

    monkeypatch.setitem(qpsolvers.solvers.solve_function, name, solve)
    for list_name in ("available_solvers", "dense_solvers"):
        monkeypatch.setattr(qpsolvers, list_name, [*getattr(qpsolvers, list_name), name])
    return name


def fails(problem: qpsolvers.Problem) -> qpsolvers.Solution:
    """Find nothing."""
    return qpsolvers.Solution(problem, found=False)


def raises(problem: qpsolvers.Problem) -> qpsolvers.Solution:
    """Raise what solvers raise."""
    raise ValueError("matrix P is not positive definite")


def lies(problem: qpsolvers.Problem) -> qpsolvers.Solution:
    """Call anything optimal."""
    n, m = len(problem.q), 0 if problem.h is None else len(problem.h)
    return qpsolvers.Solution(problem, found=True, x=np.ones(n), z=np.ones(m), z_box=-np.ones(n))


def says_nothing(problem: qpsolvers.Problem) -> qpsolvers.Solution:
    """Give the true optimum without multipliers, so that nobody can tell; nothing where none are needed.

    None are where they are so small that a certificate holds without them.
    """
    answer = qpsolvers.solve_problem(problem, "daqp")
    multipliers = [one for one in (answer.z, answer.z_box) if one is not None]
    largest = max((np.abs(one).max(initial=0.0) for one in multipliers), default=0.0)
    if largest <= SMALL * max(1.0, np.abs(problem.q).max()):
        return fails(problem)
    return qpsolvers.Solution(problem, found=True, x=answer.x)


def gives_no_numbers(problem: qpsolvers.Problem) -> qpsolvers.Solution:
    """Call NaN optimal."""
    n, m = len(problem.q), 0 if problem.h is None else len(problem.h)
    return qpsolvers.Solution(problem, found=True, x=np.full(n, np.nan), z=np.zeros(m), z_box=np.zeros(n))


FAULTS = (fails, raises, lies, says_nothing, gives_no_numbers)
