"""OSQP kept warm for programs of one layout, registered with qpsolvers under a name of its own.

A workspace has a fixed number of row slots, each of which any row of the program may take. New vectors cost
OSQP nothing, new matrix values one factorisation, a new pattern everything: so the pattern stays.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import osqp
import qpsolvers
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

PERSISTENT_OSQP = "osqp_persistent"
"""Name under which the warm workspace is registered with qpsolvers; users say ``osqp``."""

MAX_ITERATIONS = 4000
"""Beyond these OSQP has given up."""

_SOLVED = (osqp.SolverStatus.OSQP_SOLVED, osqp.SolverStatus.OSQP_SOLVED_INACCURATE)


class OsqpWorkspace:
    """A warm OSQP solver with ``slots`` rows above the bounds.

    Parameters
    ----------
    cost_pattern
        True where ``P`` may be non-zero, shape (n, n), symmetric.
    slots
        Number of rows it can take.
    tolerance
        Absolute and relative tolerance.
    """

    def __init__(self, cost_pattern: BoolArray, slots: int, tolerance: float) -> None:
        n = len(cost_pattern)
        rows = np.vstack([np.ones((slots, n), dtype=bool), np.eye(n, dtype=bool)])
        self._slots = slots
        self._P, self._P_at = _csc(np.triu(cost_pattern))
        self._A, self._A_at = _csc(rows)
        self._dense = np.zeros(rows.shape)
        self._dense[slots:] = np.eye(n)
        self._lower = np.full(len(rows), -np.inf)
        self._upper = np.full(len(rows), np.inf)
        self._settings = {
            "verbose": False,
            "eps_abs": tolerance,
            "eps_rel": tolerance,
            "max_iter": MAX_ITERATIONS,
            "check_termination": 10,
            # The active set that ADMM ends with almost always gives the exact solution for one more solve.
            "polishing": True,
            "warm_starting": True,
        }
        self._solver: Any = None
        self._last_P = np.empty(0)
        self._last_A = np.empty(0)

    def solve(self, problem: qpsolvers.Problem, start: FloatArray | None) -> qpsolvers.Solution:
        """Solve a problem of at most ``slots`` rows."""
        count = 0 if problem.G is None else problem.G.shape[0]
        self._dense[: self._slots] = 0.0
        self._upper[: self._slots] = np.inf
        if count:
            self._dense[:count] = np.asarray(problem.G)
            self._upper[:count] = problem.h
        self._lower[self._slots :] = problem.lb
        self._upper[self._slots :] = problem.ub
        P_data = np.asarray(problem.P)[self._P_at]
        A_data = self._dense[self._A_at]
        if self._solver is None:
            self._P.data[:] = P_data
            self._A.data[:] = A_data
            self._solver = osqp.OSQP()
            self._solver.setup(self._P, problem.q, self._A, self._lower, self._upper, **self._settings)
        else:
            changed: dict[str, FloatArray] = {"q": problem.q, "l": self._lower, "u": self._upper}
            if not np.array_equal(P_data, self._last_P):
                changed["Px"] = P_data
            if not np.array_equal(A_data, self._last_A):
                changed["Ax"] = A_data
            self._solver.update(**changed)
        self._last_P, self._last_A = P_data, A_data
        if start is not None:
            self._solver.warm_start(x=start)
        result = self._solver.solve(raise_error=False)
        found = result.info.status_val in _SOLVED
        return qpsolvers.Solution(
            problem=problem,
            found=found,
            x=result.x,
            z=np.maximum(result.y[:count], 0.0) if found else None,
            z_box=result.y[self._slots :] if found else None,
            extras={"info": result.info},
        )


def _csc(pattern: BoolArray) -> tuple[csc_matrix, tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Return a CSC matrix with an explicit entry for every True, and the indices of its data in order."""
    columns, rows = np.nonzero(pattern.T)
    matrix = csc_matrix((np.ones(len(rows)), (rows, columns)), shape=pattern.shape)
    matrix.sort_indices()
    return matrix, (rows, columns)


def _solve_persistent(
    problem: qpsolvers.Problem,
    initvals: FloatArray | None = None,
    verbose: bool = False,
    *,
    workspace: OsqpWorkspace,
) -> qpsolvers.Solution:
    return workspace.solve(problem, initvals)


qpsolvers.solvers.solve_function[PERSISTENT_OSQP] = _solve_persistent
