"""Quadratic programs of one fixed layout, solved again and again through qpsolvers.

``minimise 1/2 z'Pz + q'z  subject to  G z <= h,  lower <= z <= upper``

A :class:`Program` owns its arrays for the whole run. Whoever builds a problem writes values in place; the
pattern of entries that may be non-zero is declared once, so that a persistent OSQP workspace is updated and
not set up again. Any other solver that qpsolvers knows is called by its name with the same arrays.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import osqp
import qpsolvers
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

PERSISTENT_OSQP = "osqp_persistent"
"""Name under which the warm OSQP workspace is registered with qpsolvers; users say ``osqp``."""

_SOLVED = (osqp.SolverStatus.OSQP_SOLVED, osqp.SolverStatus.OSQP_SOLVED_INACCURATE)


@dataclass(frozen=True, slots=True)
class Solution:
    """A solution and its certificate."""

    z: FloatArray
    found: bool
    cost: float
    """Objective value."""
    violation: float
    """Largest violation of any row or bound, over all of them."""
    dual: FloatArray
    """Multipliers of the rows ``G z <= h``, non-negative."""
    box_dual: FloatArray
    """Multipliers of the bounds: positive at an upper, negative at a lower bound."""

    def stationarity(self, program: Program) -> float:
        """Return the largest component of ``Pz + q + G'y + y_box`` (0 at an optimum)."""
        gradient = program.P @ self.z + program.q + program.G.T @ self.dual + self.box_dual
        return float(np.abs(gradient).max())


@dataclass(slots=True)
class Program:
    """A quadratic program whose values change and whose layout does not.

    Parameters
    ----------
    cost_pattern
        True where ``P`` may be non-zero, shape (n, n), symmetric.
    row_pattern
        True where ``G`` may be non-zero, shape (m, n).
    solver
        A name that qpsolvers knows, or ``osqp`` for the persistent workspace.
    tolerance
        Absolute and relative tolerance, used with OSQP.
    equilibrate
        Passes of OSQP's own scaling; 0 for a program that is well scaled as it is.
    """

    cost_pattern: BoolArray
    row_pattern: BoolArray
    solver: str = "osqp"
    tolerance: float = 1e-4
    equilibrate: int = 10
    P: FloatArray = field(init=False)
    q: FloatArray = field(init=False)
    G: FloatArray = field(init=False)
    h: FloatArray = field(init=False)
    lower: FloatArray = field(init=False)
    upper: FloatArray = field(init=False)
    _workspace: _Workspace | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        m, n = self.row_pattern.shape
        self.P = np.zeros((n, n))
        self.q = np.zeros(n)
        self.G = np.zeros((m, n))
        self.h = np.full(m, np.inf)
        self.lower = np.full(n, -np.inf)
        self.upper = np.full(n, np.inf)
        if self.solver == "osqp":
            self._workspace = _Workspace(
                self.cost_pattern, self.row_pattern, self.tolerance, self.equilibrate
            )
        elif self.solver not in qpsolvers.available_solvers:
            known = ", ".join(sorted({*qpsolvers.available_solvers} - {PERSISTENT_OSQP}))
            raise ValueError(f"unknown solver '{self.solver}'; installed are: {known}")

    def problem(self) -> qpsolvers.Problem:
        """Return the built problem, to be looked at without being solved; rows without bound are left out."""
        rows = np.isfinite(self.h)
        return qpsolvers.Problem(self.P, self.q, self.G[rows], self.h[rows], lb=self.lower, ub=self.upper)

    def solve(self, warm: FloatArray | None = None) -> Solution:
        """Solve the program as it stands; never raises, ``found`` says whether the result may be used."""
        if not self._finite():
            return self._nothing()
        rows = np.ones(len(self.h), dtype=bool)
        if self._workspace is not None:
            problem = qpsolvers.Problem(self.P, self.q, self.G, self.h, lb=self.lower, ub=self.upper)
            answer = qpsolvers.solve_problem(
                problem, solver=PERSISTENT_OSQP, initvals=warm, workspace=self._workspace
            )
        else:
            rows = np.isfinite(self.h)
            answer = qpsolvers.solve_problem(self.problem(), solver=self.solver, initvals=warm)
        if not answer.found or answer.x is None or not np.isfinite(answer.x).all():
            return self._nothing()
        dual = np.zeros(len(self.h))
        if answer.z is not None:
            dual[rows] = np.asarray(answer.z)
        box = np.zeros(len(self.q))
        if answer.z_box is not None and len(answer.z_box):
            box = np.asarray(answer.z_box)
        z = np.asarray(answer.x, dtype=np.float64)
        return Solution(z, True, self.cost(z), self.violation(z), dual, box)

    def cost(self, z: FloatArray) -> float:
        """Return the objective at ``z``."""
        return float(0.5 * z @ (self.P @ z) + self.q @ z)

    def violation(self, z: FloatArray) -> float:
        """Return the largest violation of any row or bound at ``z``; 0 when none is violated."""
        worst = max((self.G @ z - self.h).max(initial=0.0), (self.lower - z).max(), (z - self.upper).max())
        return float(max(worst, 0.0))

    def _finite(self) -> bool:
        # One NaN in a persistent workspace spoils the solves after it, and some solvers report success on
        # NaN: such a problem is never handed to a solver.
        return bool(
            np.isfinite(self.q).all()
            and np.isfinite(self.P).all()
            and np.isfinite(self.G).all()
            and not np.isnan(self.h).any()
            and not np.isnan(self.lower).any()
            and not np.isnan(self.upper).any()
        )

    def _nothing(self) -> Solution:
        if self._workspace is not None:
            self._workspace.discard()
        n, m = len(self.q), len(self.h)
        return Solution(np.zeros(n), False, np.inf, np.inf, np.zeros(m), np.zeros(n))


class _Workspace:
    """A warm OSQP solver for one pattern; ``discard`` makes the next solve set it up afresh."""

    def __init__(
        self, cost_pattern: BoolArray, row_pattern: BoolArray, tolerance: float, equilibrate: int
    ) -> None:
        n = cost_pattern.shape[0]
        upper_triangle = np.triu(cost_pattern)
        all_rows = np.vstack([row_pattern, np.eye(n, dtype=bool)])
        self._P, self._P_at = _csc(upper_triangle)
        self._A, self._A_at = _csc(all_rows)
        self._rows = row_pattern.shape[0]
        self._dense = np.zeros(all_rows.shape)
        self._dense[self._rows :] = np.eye(n)
        self._lower = np.full(len(all_rows), -np.inf)
        self._upper = np.full(len(all_rows), np.inf)
        self._settings = {
            "verbose": False,
            "eps_abs": tolerance,
            "eps_rel": tolerance,
            "max_iter": 4000,
            "check_termination": 10,
            # The active set that ADMM ends with almost always gives the exact solution for one more solve.
            "polishing": True,
            "scaling": equilibrate,
            "warm_starting": True,
        }
        self._solver: Any = None
        self._last_P = np.empty(0)
        self._last_A = np.empty(0)

    def discard(self) -> None:
        self._solver = None

    def solve(self, problem: qpsolvers.Problem, warm: FloatArray | None) -> qpsolvers.Solution:
        self._dense[: self._rows] = np.asarray(problem.G)
        P_data = np.asarray(problem.P)[self._P_at]
        A_data = self._dense[self._A_at]
        self._upper[: self._rows] = problem.h
        self._lower[self._rows :] = problem.lb
        self._upper[self._rows :] = problem.ub
        if self._solver is None:
            self._P.data[:] = P_data
            self._A.data[:] = A_data
            self._solver = osqp.OSQP()
            self._solver.setup(self._P, problem.q, self._A, self._lower, self._upper, **self._settings)
        else:
            changed: dict[str, FloatArray] = {"q": problem.q, "l": self._lower, "u": self._upper}
            # New matrix values cost a factorisation; new vectors do not.
            if not np.array_equal(P_data, self._last_P):
                changed["Px"] = P_data
            if not np.array_equal(A_data, self._last_A):
                changed["Ax"] = A_data
            self._solver.update(**changed)
        self._last_P, self._last_A = P_data, A_data
        if warm is not None:
            self._solver.warm_start(x=warm)
        result = self._solver.solve(raise_error=False)
        found = result.info.status_val in _SOLVED
        return qpsolvers.Solution(
            problem=problem,
            found=found,
            x=result.x,
            z=np.maximum(result.y[: self._rows], 0.0) if found else None,
            z_box=result.y[self._rows :] if found else None,
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
    workspace: _Workspace,
) -> qpsolvers.Solution:
    return workspace.solve(problem, initvals)


qpsolvers.solvers.solve_function[PERSISTENT_OSQP] = _solve_persistent
