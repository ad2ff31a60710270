"""OSQP that keeps its workspace from one problem to the next, registered with qpsolvers under its own name.

New vectors cost OSQP nothing, new values in matrices cost one factorisation, and a new sparsity pattern costs
a complete setup. The pattern is that of all problems so far: an entry that was once non-zero stays in it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import osqp
import qpsolvers
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from controllers.arrays import BoolArray, FloatArray

WARM_OSQP = "osqp_warm"
"""Name under which the workspace is registered with qpsolvers; users say ``osqp``."""

MAX_ITERATIONS = 4000
"""OSQP gives up after this many iterations."""

_SOLVED = (osqp.SolverStatus.OSQP_SOLVED, osqp.SolverStatus.OSQP_SOLVED_INACCURATE)
# The certificate decides whether an inaccurate solution is good enough.


class _Matrix:
    """A matrix whose values change within a pattern that only grows."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self._pattern: BoolArray = np.zeros(shape, dtype=bool)
        self._at: tuple[NDArray[np.intp], NDArray[np.intp]] = (np.empty(0, np.intp), np.empty(0, np.intp))
        self._last: FloatArray = np.empty(0)

    def grown_by(self, values: FloatArray) -> bool:
        """Add a matrix's non-zero entries to the pattern; return whether any was new."""
        entries = values != 0.0
        if not (entries & ~self._pattern).any():
            return False
        self._pattern |= entries
        columns, rows = np.nonzero(self._pattern.T)
        self._at = (rows, columns)
        return True

    def changed(self, values: FloatArray) -> FloatArray | None:
        """Return the values of the entries, column by column; ``None`` if they are those of the last call."""
        data = values[self._at]
        if np.array_equal(data, self._last):
            return None
        self._last = data
        return np.asarray(data)

    def sparse(self, values: FloatArray) -> csc_matrix:
        """Return a matrix with the whole pattern, including entries that are 0."""
        starts = np.append(0, np.cumsum(self._pattern.sum(axis=0)))
        self._last = values[self._at]
        return csc_matrix((self._last, self._at[0], starts), shape=self._pattern.shape)


class Workspace:
    """A warm OSQP solver for problems of one shape."""

    def __init__(self) -> None:
        self._settings = {
            "verbose": False,
            "max_iter": MAX_ITERATIONS,
            "check_termination": 10,
            # One more solve with the active set that ADMM ends with almost always gives the exact solution.
            "polishing": True,
            "warm_starting": True,
        }
        self._cost: _Matrix | None = None
        self._rows: _Matrix | None = None
        self._solver: Any = None

    def solve(
        self, problem: qpsolvers.Problem, start: FloatArray | None, tolerance: float
    ) -> qpsolvers.Solution:
        """Solve a problem that has rows and bounds; infinite ones have no effect.

        ``tolerance`` is both the absolute and the relative tolerance of OSQP.
        """
        cost, q, G, h, *_, lb, ub = (np.asarray(one, np.float64) for one in problem.unpack_as_dense())
        n, count = len(q), len(h)
        P, A = np.triu(cost), np.concatenate((G, np.eye(n)))
        lower = np.concatenate((np.full(count, -np.inf), lb))
        upper = np.concatenate((h, ub))
        if self._cost is None or self._rows is None:
            self._cost, self._rows = _Matrix(P.shape), _Matrix(A.shape)
        grown = self._cost.grown_by(P) | self._rows.grown_by(A)
        if grown or self._solver is None:
            self._solver = osqp.OSQP()
            matrices = self._cost.sparse(P), self._rows.sparse(A)
            self._solver.setup(
                matrices[0],
                q,
                matrices[1],
                lower,
                upper,
                eps_abs=tolerance,
                eps_rel=tolerance,
                **self._settings,
            )
        else:
            values = {"Px": self._cost.changed(P), "Ax": self._rows.changed(A)}
            new = {name: data for name, data in values.items() if data is not None}
            self._solver.update(q=q, l=lower, u=upper, **new)
            self._solver.update_settings(eps_abs=tolerance, eps_rel=tolerance)
        if start is not None:
            self._solver.warm_start(x=start)
        result = self._solver.solve(raise_error=False)
        found = result.info.status_val in _SOLVED
        return qpsolvers.Solution(
            problem=problem,
            found=found,
            x=result.x,
            z=result.y[:count] if found else None,
            z_box=result.y[count:] if found else None,
            extras={"info": result.info},
        )


def _solve_warm(
    problem: qpsolvers.Problem,
    initvals: FloatArray | None = None,
    verbose: bool = False,
    *,
    workspace: Workspace,
    tolerance: float,
) -> qpsolvers.Solution:
    return workspace.solve(problem, initvals, tolerance)


qpsolvers.solvers.solve_function[WARM_OSQP] = _solve_warm
