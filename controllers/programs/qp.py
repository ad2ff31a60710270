"""Quadratic programs of one fixed layout, solved again and again through qpsolvers.

``minimise 1/2 z'Pz + q'z  subject to  G z <= h,  lower <= z <= upper``

A :class:`Program` owns its arrays for the whole run. Whoever builds a problem writes values in place. A solve
first looks near the rows that bound the last optimum (:mod:`controllers.programs.active_set`). Where the new
one is not there, the solver is called: few rows bind, so it begins with those nearest to binding, all are
verified at its result, the violated ones are added, until none is. The optimum is that of the whole program.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import qpsolvers
from numpy.typing import NDArray

from controllers.programs.active_set import KEPT, ActiveSet
from controllers.programs.osqp_workspace import PERSISTENT_OSQP, OsqpWorkspace

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

FIRST_ROWS = 20
"""Rows that a solve begins with."""
ADDED_ROWS = 8
"""Violated rows added at once."""
SLOTS = 40
"""Rows that the smallest OSQP workspace takes; each larger one takes twice as many."""
FEASIBLE = 1e-6
"""A row violated by no more than this counts as kept."""
CHANGES = {"osqp": 100}
"""Changes of the active set after which a solver is called."""
FEWEST_CHANGES = 1
"""The same for solvers that walk along active sets themselves: one is tried."""
COMPILED_CHANGES = 150
"""The same for all solvers where the search is compiled."""
ACTIVE = 1e-7
"""A larger multiplier marks an active row."""
_NO_ROWS = np.empty(0, dtype=np.int64)


class Solution(NamedTuple):
    """A solution and its certificate."""

    z: FloatArray
    found: bool
    cost: float
    """Objective value."""
    violation: float
    """Largest violation of any row or bound, over all of them."""
    active: IntArray
    """What binds: rows, then upper, then lower bounds."""
    multipliers: FloatArray
    """Of these, non-negative."""
    rows: int
    """How many rows ``G z <= h`` there are."""

    @property
    def dual(self) -> FloatArray:
        """Multipliers of the rows ``G z <= h``, non-negative."""
        return self._all_multipliers()[: self.rows]

    @property
    def box_dual(self) -> FloatArray:
        """Multipliers of the bounds: positive at an upper, negative at a lower bound."""
        upper, lower = self._all_multipliers()[self.rows :].reshape(2, -1)
        return np.asarray(upper - lower)

    def _all_multipliers(self) -> FloatArray:
        everything = np.zeros(self.rows + 2 * len(self.z))
        everything[self.active] = self.multipliers
        return everything

    def stationarity(self, program: Program) -> float:
        """Return the largest component of ``Pz + q + G'y + y_box`` (0 at an optimum)."""
        gradient = program.P @ self.z + program.q + program.G.T @ self.dual + self.box_dual
        return float(np.abs(gradient).max())


@dataclass(slots=True)
class Memory:
    """What one ego's solves leave for the next: all that must not be shared."""

    active: dict[Hashable, IntArray] = field(default_factory=dict)
    """Rows that bound the last program of each kind."""
    workspaces: dict[int, OsqpWorkspace] = field(default_factory=dict)
    """By the rows that they take."""
    last: FloatArray | None = None
    """Where the last solve ended."""

    def forget(self) -> None:
        """Begin anew, after a program without solution."""
        self.active.clear()
        self.workspaces.clear()
        self.last = None


@dataclass(slots=True)
class Program:
    """A quadratic program whose values change and whose layout does not.

    Between two solves it holds nothing that matters: all egos of one kind may write their tasks into the
    same, each with a :class:`Memory` of its own. That keeps a hundred of them within the processor's caches.

    Parameters
    ----------
    cost_pattern
        True where ``P`` may be non-zero, shape (n, n), symmetric.
    row_pattern
        True where ``G`` may be non-zero, shape (m, n).
    solver
        A name that qpsolvers knows; ``osqp`` is kept warm between solves.
    tolerance
        Absolute and relative tolerance, used with OSQP.
    changes
        Changes of the last active set to try before the solver is called; negative: always call it. ``None``:
        what pays with the solver.
    compiled
        Whether the search near the last active rows is compiled.
    constant_cost
        Whether ``P`` stays the same; only the effort depends on it.

    Raises
    ------
    ValueError
        If the solver is not installed.
    """

    cost_pattern: BoolArray
    row_pattern: BoolArray
    solver: str = "osqp"
    tolerance: float = 1e-4
    changes: int | None = None
    compiled: bool = False
    constant_cost: bool = False
    P: FloatArray = field(init=False)
    q: FloatArray = field(init=False)
    G: FloatArray = field(init=False)
    h: FloatArray = field(init=False)
    lower: FloatArray = field(init=False)
    upper: FloatArray = field(init=False)
    _rows: FloatArray = field(init=False)
    """All rows: ``G``, then the bounds as rows."""
    _bounds: FloatArray = field(init=False)
    _near: ActiveSet = field(init=False)
    _memory: Memory = field(init=False)

    def __post_init__(self) -> None:
        m, n = self.row_pattern.shape
        self.P = np.zeros((n, n))
        self.q = np.zeros(n)
        self._rows = np.concatenate((np.zeros((m, n)), np.eye(n), -np.eye(n)))
        self._bounds = np.full(m + 2 * n, np.inf)
        # Views: what is written into them needs no copying.
        self.G, self.h, self.upper = self._rows[:m], self._bounds[:m], self._bounds[m : m + n]
        self.lower = np.full(n, -np.inf)
        check_solver(self.solver)
        self._near = ActiveSet(self.compiled, self.constant_cost)
        self._memory = Memory()
        if self.changes is None:
            self.changes = COMPILED_CHANGES if self.compiled else CHANGES.get(self.solver, FEWEST_CHANGES)

    def problem(self) -> qpsolvers.Problem:
        """Return the built problem, to be looked at without being solved; rows without bound are left out."""
        return self._problem(np.flatnonzero(np.isfinite(self.h)))

    def solve(
        self, warm: FloatArray | None = None, kind: Hashable = None, memory: Memory | None = None
    ) -> Solution:
        """Solve the program as it stands; never raises, ``found`` says whether the result may be used.

        Parameters
        ----------
        warm : where the solver begins, shape (n,)
        kind : problems of one kind tend to be bound by the same rows
        memory : of whoever asks, where several share the program
        """
        memory = self._memory if memory is None else memory
        near = self._near_the_last(kind, memory)
        if near is not None:
            return near
        if not self._is_number():
            return self._nothing(memory)
        start = warm if warm is not None else memory.last
        z = np.zeros(len(self.q)) if start is None else start
        room = self.h - self.G @ z
        order = np.argsort(room, kind="stable")[:FIRST_ROWS]
        rows = order[np.isfinite(room[order])]
        while True:
            answer = self._solve_rows(rows, start, memory)
            if not answer.found or answer.x is None or not np.isfinite(answer.x).all():
                return self._nothing(memory)
            z = np.asarray(answer.x, dtype=np.float64)
            over = self.G @ z - self.h
            over[rows] = -np.inf
            worst = np.argsort(-over, kind="stable")[:ADDED_ROWS]
            added = worst[over[worst] > FEASIBLE]
            if not len(added):
                break
            rows, start = np.concatenate((rows, added)), z
        memory.last = z
        multipliers = np.zeros(len(self._bounds))
        if answer.z is not None and len(rows):
            multipliers[rows] = np.asarray(answer.z)
        if answer.z_box is not None and len(answer.z_box):
            box = np.asarray(answer.z_box)
            multipliers[len(self.h) :] = np.maximum(np.concatenate((box, -box)), 0.0)
        memory.active[kind] = np.flatnonzero(multipliers > ACTIVE)
        bound = np.flatnonzero(multipliers)
        return Solution(z, True, self.cost(z), self.violation(z), bound, multipliers[bound], len(self.h))

    def _near_the_last(self, kind: Hashable, memory: Memory) -> Solution | None:
        """Return the optimum where the rows that bound the last one lead to it; ``None`` otherwise."""
        if self.changes is None or self.changes < 0:
            return None
        m, n = self.row_pattern.shape
        np.negative(self.lower, out=self._bounds[m + n :])
        guess = memory.active.get(kind, _NO_ROWS)
        found = self._near.resume(self.P, self.q, self._rows, self._bounds, guess, self.changes)
        if found is None:
            return None
        memory.active[kind] = found.active
        memory.last = found.z
        return Solution(found.z, True, found.cost, KEPT, found.active, found.multipliers, m)

    def cost(self, z: FloatArray) -> float:
        """Return the objective at ``z``."""
        return float(0.5 * z @ (self.P @ z) + self.q @ z)

    def violation(self, z: FloatArray) -> float:
        """Return the largest violation of any row or bound at ``z``; 0 when none is violated."""
        worst = max((self.G @ z - self.h).max(initial=0.0), (self.lower - z).max(), (z - self.upper).max())
        return float(max(worst, 0.0))

    def _problem(self, rows: IntArray) -> qpsolvers.Problem:
        G, h = (self.G[rows], self.h[rows]) if len(rows) else (None, None)
        return qpsolvers.Problem(self.P, self.q, G, h, lb=self.lower, ub=self.upper)

    def _solve_rows(self, rows: IntArray, start: FloatArray | None, memory: Memory) -> qpsolvers.Solution:
        problem = self._problem(rows)
        if self.solver != "osqp":
            return qpsolvers.solve_problem(problem, solver=self.solver, initvals=start)
        slots = SLOTS
        while slots < len(rows):
            slots *= 2
        if slots not in memory.workspaces:
            memory.workspaces[slots] = OsqpWorkspace(self.cost_pattern, slots, self.tolerance)
        return qpsolvers.solve_problem(
            problem, solver=PERSISTENT_OSQP, initvals=start, workspace=memory.workspaces[slots]
        )

    def _is_number(self) -> bool:
        # One NaN in a warm workspace spoils the solves after it, and some solvers report success on NaN:
        # such a problem is never handed to a solver. A sum is NaN or infinite when any term is.
        if np.isnan(self._bounds).any() or np.isnan(self.lower).any():
            return False
        return bool(np.isfinite(self.P.sum() + self.q.sum() + self.G.sum()))

    def _nothing(self, memory: Memory) -> Solution:
        memory.forget()
        none = np.zeros(len(self.q))
        return Solution(none, False, np.inf, np.inf, _NO_ROWS, np.empty(0), len(self.h))


def check_solver(name: str) -> None:
    """Raise ``ValueError``, with what is installed, when qpsolvers does not know a solver."""
    if name not in qpsolvers.available_solvers:
        known = ", ".join(sorted(qpsolvers.available_solvers))
        raise ValueError(f"unknown solver '{name}'; installed are: {known}")
