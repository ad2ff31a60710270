"""The optimum of a quadratic program near the set of rows that bound the last one.

From one step to the next a plan's active rows change little. With a guess of them the optimum is one small
linear system away; while it breaks a row, or a multiplier is negative, rows are added and dropped one by one
as the dual method of [GI1983]_ does. Whoever gives up after a few changes has lost little and hands the
program to a general solver.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

KEPT = 1e-8
"""A row violated by no more than this counts as kept; the rows' gradients are of the order of 1."""
FLAT = 1e-11
"""A row with less curvature along its step depends on the active ones."""


def search(
    P: FloatArray,
    q: FloatArray,
    inverse: FloatArray,
    A: FloatArray,
    b: FloatArray,
    guess: IntArray,
    most: int,
) -> tuple[bool, FloatArray, IntArray, FloatArray, float]:
    """Find the minimum of ``1/2 z'Pz + q'z`` subject to ``A z <= b``.

    Parameters
    ----------
    P : positive definite, shape (n, n)
    q : shape (n,)
    inverse : of P
    A, b : shapes (m, n) and (m,); rows without bound have ``b = inf``
    guess : rows that may be active
    most : changes of the active set after which the search is given up

    Returns
    -------
    Whether it was found; it, shape (n,); the rows that bind it, and their multipliers; the objective there.
    """
    free = -(inverse @ q)
    active = guess[np.isfinite(b[guess])]
    rows = A[active]
    pulls = rows @ inverse  # what each active row moves the point by, per unit of its multiplier
    gram = rows @ pulls.T
    room = rows @ free - b[active]
    found, changes, z, multipliers = False, 0, free, np.zeros(0)
    while True:
        # Anew from the rows: what the steps' rounding adds up to would stay otherwise.
        multipliers, failed = solved(gram, room)
        if failed:  # rows that depend on each other
            break
        pulling = multipliers < 0.0
        if pulling.any():
            kept = np.flatnonzero(~pulling)
            active, room, pulls, gram = active[kept], room[kept], pulls[kept], gram[kept][:, kept]
            continue
        z = free - multipliers @ pulls
        over = A @ z - b
        row = int(np.argmax(over))
        worst = over[row]
        # What is not a number, or infinite, gives no answer, wherever in the program it stands.
        if changes == most or worst <= KEPT or not np.isfinite(worst):
            found = bool(worst <= KEPT and (np.isfinite(over) | np.isinf(b)).all())
            break
        changes += 1
        normal = A[row]
        pull = inverse @ normal
        possible, kept, multipliers = entered(gram, pulls, multipliers, normal, pull, worst)
        if not possible:
            break
        active, room, pulls, gram = active[kept], room[kept], pulls[kept], gram[kept][:, kept]
        active, room, pulls, gram = with_row(
            active, room, pulls, gram, row, normal, pull, float(normal @ free) - b[row]
        )
    cost = float(0.5 * (z @ (P @ z)) + q @ z)
    return found and bool(np.isfinite(cost)), z, active, multipliers, cost


def entered(
    gram: FloatArray,
    pulls: FloatArray,
    multipliers: FloatArray,
    normal: FloatArray,
    pull: FloatArray,
    violation: float,
) -> tuple[bool, IntArray, FloatArray]:
    """Say whether a violated row can be made active, and which active ones stay, with their multipliers."""
    kept = np.arange(len(multipliers))
    while True:
        cross = pulls @ normal
        answer, failed = solved(gram, cross)
        if failed:
            return False, kept, multipliers
        curvature = float(normal @ pull - cross @ answer)
        full = violation / curvature if curvature > FLAT else np.inf
        ratio, leaving = np.inf, -1
        for i in range(len(answer)):
            if answer[i] > FLAT and multipliers[i] / answer[i] < ratio:
                ratio, leaving = multipliers[i] / answer[i], i
        step = min(full, ratio)
        if step == np.inf:
            return False, kept, multipliers
        multipliers = np.maximum(multipliers - step * answer, 0.0)
        if step == full:
            return True, kept, multipliers
        violation -= step * max(curvature, 0.0)
        stay = np.flatnonzero(np.arange(len(multipliers)) != leaving)
        kept, multipliers, pulls, gram = kept[stay], multipliers[stay], pulls[stay], gram[stay][:, stay]


def with_row(
    active: IntArray,
    room: FloatArray,
    pulls: FloatArray,
    gram: FloatArray,
    row: int,
    normal: FloatArray,
    pull: FloatArray,
    its_room: float,
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return what is kept of the active rows with one more among them."""
    count = len(active)
    larger = np.empty((count + 1, count + 1))
    larger[:count, :count] = gram
    larger[count, :count] = larger[:count, count] = pulls @ normal
    larger[count, count] = normal @ pull
    more = np.empty((count + 1, len(pull)))
    more[:count], more[count] = pulls, pull
    return np.append(active, row), np.append(room, its_room), more, larger


def solved(matrix: FloatArray, right: FloatArray) -> tuple[FloatArray, bool]:
    """Return ``x`` with ``matrix x = right``, and whether the matrix is not positive definite."""
    if len(right) == 0:
        return right, False
    _, x, failed = dposv(matrix, right)
    return x, failed != 0


def solved_in_loops(matrix: FloatArray, right: FloatArray) -> tuple[FloatArray, bool]:
    """Do the same by Cholesky's factors; the matrices are small."""
    n = len(right)
    factor = np.empty((n, n))
    x = right.copy()
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = rest / factor[j, j]
            elif rest > 0.0:
                factor[i, i] = np.sqrt(rest)
            else:
                return x, True
        for k in range(i):
            x[i] -= factor[i, k] * x[k]
        x[i] /= factor[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= factor[k, i] * x[k]
        x[i] /= factor[i, i]
    return x, False
