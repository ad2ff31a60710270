"""The optimum of a quadratic program near the set of rows that bound the last one.

From one step to the next a plan's active rows change little. With a guess of them the optimum is one small
linear system away; while it breaks a row, or a multiplier is negative, rows are added and dropped one by one
as the dual method of [GI1983]_ does. Whoever gives up after a few changes has lost little and hands the
program to a general solver.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

KEPT = 1e-8
"""A row violated by no more than this counts as kept; the rows' gradients are of the order of 1."""
FLAT = 1e-11
"""A row with less curvature along its step depends on the active ones."""


@dataclass(frozen=True, slots=True)
class Optimum:
    """A point that meets the optimality conditions."""

    z: FloatArray
    active: IntArray
    """Rows that bound it."""
    multipliers: FloatArray
    """Of these, non-negative."""


@dataclass(slots=True)
class ActiveSet:
    """Searches from guessed active rows; remembers the inverse of the cost matrix."""

    _cost: FloatArray = field(default_factory=lambda: np.empty(0))
    _inverse: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def resume(
        self, P: FloatArray, q: FloatArray, A: FloatArray, b: FloatArray, guess: IntArray, most: int
    ) -> Optimum | None:
        """Return the minimum of ``1/2 z'Pz + q'z`` subject to ``A z <= b``; ``None`` when it is not near.

        Parameters
        ----------
        P : positive definite, shape (n, n)
        q : shape (n,)
        A, b : shapes (m, n) and (m,); rows without bound have ``b = inf``
        guess : rows that may be active
        most : changes of the active set after which the search is given up

        Examples
        --------
        The point nearest to (2, 1) left of z0 = 1:

        >>> row, bound = np.array([[1.0, 0.0]]), np.array([1.0])
        >>> nobody = np.empty(0, dtype=np.int64)
        >>> found = ActiveSet().resume(np.eye(2), np.array([-2.0, -1.0]), row, bound, nobody, most=3)
        >>> found.z.tolist(), found.active.tolist(), found.multipliers.tolist()
        ([1.0, 1.0], [0], [1.0])
        """
        try:
            return self._search(P, q, A, b, guess, most)
        except np.linalg.LinAlgError:  # the guessed rows depend on each other
            return None

    def _search(
        self, P: FloatArray, q: FloatArray, A: FloatArray, b: FloatArray, guess: IntArray, most: int
    ) -> Optimum | None:
        if P.shape != self._cost.shape or not np.array_equal(P, self._cost):
            self._inverse, self._cost = _solve(P, np.eye(len(P))), P.copy()
        inverse = self._inverse
        free = -(inverse @ q)
        active = guess[np.isfinite(b[guess])]
        active, multipliers, reaction = _without_pulling(inverse, free, A, b, active)
        z = free - reaction @ multipliers
        for _ in range(most + 1):
            over = A @ z - b
            row = int(over.argmax())
            if over[row] <= KEPT:
                return Optimum(z, active, multipliers)
            entered = _enter(inverse, A, row, float(over[row]), active, multipliers)
            if entered is None:
                return None
            active, multipliers = entered
            # Anew from the rows: what the steps' rounding adds up to would stay otherwise.
            active, multipliers, reaction = _without_pulling(inverse, free, A, b, active)
            z = free - reaction @ multipliers
        return None


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Return ``x`` with ``matrix x = right``, for a symmetric positive definite matrix."""
    _, x, failed = dposv(matrix, right)
    if failed:
        raise np.linalg.LinAlgError("not positive definite")
    return np.asarray(x, dtype=np.float64)


def _without_pulling(
    inverse: FloatArray, free: FloatArray, A: FloatArray, b: FloatArray, active: IntArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return active rows, multipliers and ``P⁻¹ A'`` once no active row pulls the point towards itself."""
    while len(active):
        rows = A[active]
        reaction = inverse @ rows.T
        multipliers = _solve(rows @ reaction, rows @ free - b[active])
        if multipliers.min() >= 0.0:
            return active, multipliers, reaction
        active = active[multipliers >= 0.0]
    return active, np.empty(0), np.empty((len(free), 0))


def _enter(
    inverse: FloatArray,
    A: FloatArray,
    row: int,
    violation: float,
    active: IntArray,
    multipliers: FloatArray,
) -> tuple[IntArray, FloatArray] | None:
    """Return the active rows and multipliers with a violated row among them; ``None`` without solution."""
    normal = A[row]
    pull = inverse @ normal
    own = 0.0
    while True:
        rows = A[active]
        reaction = inverse @ rows.T
        answer = _solve(rows @ reaction, rows @ pull) if len(active) else np.empty(0)
        curvature = float(normal @ (pull - reaction @ answer))
        full = violation / curvature if curvature > FLAT else np.inf
        yielding = np.flatnonzero(answer > FLAT)
        ratios = multipliers[yielding] / answer[yielding]
        step = min(full, float(ratios.min(initial=np.inf)))
        if step == np.inf:
            return None
        multipliers = np.maximum(multipliers - step * answer, 0.0)
        own += step
        if step == full:
            return np.append(active, row), np.append(multipliers, own)
        violation -= step * max(curvature, 0.0)
        leaving = int(yielding[ratios.argmin()])
        active, multipliers = np.delete(active, leaving), np.delete(multipliers, leaving)
