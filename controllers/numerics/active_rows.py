"""The optimum of a quadratic program near the set of rows that bound the last one.

From one step to the next a plan's active rows change little. With a guess of them the optimum is one small
linear system away; while it breaks a row, rows enter and leave as in the dual method of [GI1983]_, only that
several enter at once: of neighbouring rows, which often bind together, the one that is broken most. What is
maximised rises with each change, so the search ends. Whoever gives up after a few changes has lost little and
hands the program to a general solver.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv, dpotrf, dtrtri

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

KEPT = 1e-8
"""A row violated by no more than this counts as kept; the rows' gradients are of the order of 1."""
FLAT = 1e-11
"""A row with less curvature along its step depends on the active ones."""
AT_ONCE = 6
"""Rows that enter together."""
COST, FACTOR, INVERSE = range(3)
"""What is remembered of the last cost matrix: itself, its factor, its inverse."""


def search(
    P: FloatArray, q: FloatArray, A: FloatArray, b: FloatArray, guess: IntArray, most: int, memory: FloatArray
) -> tuple[bool, FloatArray, IntArray, FloatArray, float]:
    """Find the minimum of ``1/2 z'Pz + q'z`` subject to ``A z <= b``.

    Parameters
    ----------
    P : positive definite, shape (n, n)
    q : shape (n,)
    A, b : shapes (m, n) and (m,); rows without bound have ``b = inf``
    guess : rows that may be active
    most : rows that may enter before the search is given up
    memory : written by the last search, NaN before the first one, shape (3, n, n); compiled, shape (2, n, n)
        saves the inverse where the matrix is another one each time

    Returns
    -------
    Whether it was found; it, shape (n,); the rows that bind it, and their multipliers; the objective there.
    """
    z = np.zeros(len(q))
    active, multipliers = guess[:0], z[:0]
    if not remembered(P, memory):
        return False, z, active, multipliers, np.inf
    inverse = memory[INVERSE]
    free = -(inverse @ q)
    active = guess[np.isfinite(b[guess])]
    rows = A[active]
    pulls = rows @ inverse  # what each active row moves the point by, per unit of its multiplier
    gram = rows @ pulls.T
    room = rows @ free - b[active]
    multipliers, failed = solved(gram, room)
    if failed:  # Rows that depend on each other: begin with none.
        active, pulls, gram, room, multipliers = active[:0], pulls[:0], gram[:0, :0], room[:0], room[:0]
    while len(active) and multipliers.min() < 0.0:
        kept = np.flatnonzero(multipliers >= 0.0)
        active, room, pulls, gram = active[kept], room[kept], pulls[kept], gram[kept][:, kept]
        multipliers = solved(gram, room)[0]
    found, changes = False, 0
    while True:
        z = free - multipliers @ pulls
        over = A @ z - b
        row = int(over.argmax())
        worst = over[row]
        # What is not a number, or infinite, gives no answer, wherever in the program it stands.
        if changes == most or worst <= KEPT or not np.isfinite(worst):
            found = bool(worst <= KEPT and (np.isfinite(over) | np.isinf(b)).all())
            break
        entering = broken(over)[: most - changes]
        grown = with_rows(A, b, free, inverse, active, room, pulls, gram, entering)
        wanted, failed = solved(grown[3], grown[1])
        gained = 0.0
        if failed and len(entering) > 1:
            entering = entering[:1]
            grown = with_rows(A, b, free, inverse, active, room, pulls, gram, entering)
            wanted, failed = solved(grown[3], grown[1])
        while failed:
            # The new multiplier grows at the others' expense until the first of these is used up.
            spent = solved(gram, grown[3][-1, :-1])[0]
            spending = spent > FLAT
            if not spending.any():  # rows that exclude each other
                return False, z, active, multipliers, np.inf
            ratios = np.where(spending, multipliers, np.inf) / np.where(spending, spent, 1.0)
            step = ratios.min()
            gained += step
            multipliers = np.maximum(multipliers - step * spent, 0.0)
            kept = np.flatnonzero(np.arange(len(active)) != ratios.argmin())
            active, room, multipliers = active[kept], room[kept], multipliers[kept]
            pulls, gram = pulls[kept], gram[kept][:, kept]
            grown = with_rows(A, b, free, inverse, active, room, pulls, gram, entering)
            wanted, failed = solved(grown[3], grown[1])
        active, room, pulls, gram = grown
        changes += len(entering)
        before, multipliers = multipliers, np.zeros(len(active))
        multipliers[: len(before)], multipliers[-1] = before, gained
        while len(wanted) and wanted.min() < 0.0:
            # As far as all stay non-negative; who would not leaves.
            pulling = wanted < 0.0
            falls = np.where(pulling, multipliers - wanted, 1.0)
            ratios = np.where(pulling, multipliers, np.inf) / falls
            step = ratios.min()
            kept = np.flatnonzero(ratios != step)
            if len(kept) == len(active):  # not numbers
                return False, z, active, multipliers, np.inf
            multipliers = np.maximum(multipliers + step * (wanted - multipliers), 0.0)[kept]
            active, room, pulls, gram = active[kept], room[kept], pulls[kept], gram[kept][:, kept]
            wanted = solved(gram, room)[0]
        multipliers = wanted
    cost = float(0.5 * (q @ z - multipliers @ b[active]))
    return found and bool(np.isfinite(cost)), z, active, multipliers, cost


def search_in_loops(
    P: FloatArray, q: FloatArray, A: FloatArray, b: FloatArray, guess: IntArray, most: int, memory: FloatArray
) -> tuple[bool, FloatArray, IntArray, FloatArray, float]:
    """Do the same; what is known of the active rows grows and shrinks in place, row by row."""
    n = len(q)
    free, z, over = np.zeros(n), np.zeros(n), np.empty(len(b))
    # One row more than can be active: for one that is tried.
    active, chosen = np.empty(n + 1, dtype=np.int64), np.empty(AT_ONCE, dtype=np.int64)
    room, forward = np.empty(n + 1), np.empty(n + 1)
    multipliers, wanted = np.empty(n + 1), np.empty(n + 1)
    pulls, gram, factor = np.empty((n + 1, n)), np.empty((n + 1, n + 1)), np.empty((n + 1, n + 1))
    count, changes, found = 0, 0, False
    if not remembered(P, memory):
        return found, z, active[:0], multipliers[:0], np.inf
    pulled(memory, q, free)
    for i in range(n):
        free[i] = -free[i]
    for row in guess:
        if count < n and np.isfinite(b[row]):
            active[count], multipliers[count] = row, 0.0
            room[count] = dot(A[row], free, n) - b[row]
            count += tried(memory, A[row], count, pulls, gram, factor, room, forward)
    while solve_back(factor, forward, multipliers, count):
        for i in range(count):
            wanted[i] = multipliers[i]
        count = without(wanted, count, active, room, multipliers, pulls, gram, factor, forward)
    while True:
        for i in range(n):
            z[i] = free[i]
        for k in range(count):
            for i in range(n):
                z[i] -= multipliers[k] * pulls[k, i]
        np.dot(A, z, over)
        worst, row, number = -np.inf, 0, True
        for i in range(len(b)):
            over[i] -= b[i]
            if over[i] > worst:
                worst, row = over[i], i
            elif not over[i] > -np.inf and not (over[i] == -np.inf and b[i] == np.inf):
                number = False
        if not number or worst == np.inf:
            break
        found = worst <= KEPT
        if found or changes == most:
            break
        entered = 0
        for i in range(chosen_rows(over, min(AT_ONCE, most - changes), chosen)):
            if count < n:
                normal = A[chosen[i]]
                active[count], multipliers[count] = chosen[i], 0.0
                room[count] = dot(normal, free, n) - b[chosen[i]]
                if tried(memory, normal, count, pulls, gram, factor, room, forward):
                    count, entered = count + 1, entered + 1
        if not entered:
            # All depend on the active ones. The new multiplier grows at the others' expense until the first
            # of these is used up.
            gained = 0.0
            while True:
                active[count], multipliers[count] = row, gained
                room[count] = dot(A[row], free, n) - b[row]
                if tried(memory, A[row], count, pulls, gram, factor, room, forward) and count < n:
                    break
                solve_back(factor, factor[count], wanted, count)
                step, leaving = np.inf, -1
                for i in range(count):
                    if wanted[i] > FLAT and multipliers[i] / wanted[i] < step:
                        step, leaving = multipliers[i] / wanted[i], i
                if leaving < 0:  # rows that exclude each other
                    return False, z, active[:0], multipliers[:0], np.inf
                gained += step
                for i in range(count):
                    multipliers[i] = max(multipliers[i] - step * wanted[i], 0.0)
                    wanted[i] = -1.0 if i == leaving else 1.0
                count = without(wanted, count, active, room, multipliers, pulls, gram, factor, forward)
            count, entered = count + 1, 1
        changes += entered
        while solve_back(factor, forward, wanted, count):
            step = np.inf
            for i in range(count):
                if wanted[i] < 0.0:
                    step = min(step, multipliers[i] / (multipliers[i] - wanted[i]))
            for i in range(count):
                ratio = multipliers[i] / (multipliers[i] - wanted[i]) if wanted[i] < 0.0 else np.inf
                multipliers[i] = max(multipliers[i] + step * (wanted[i] - multipliers[i]), 0.0)
                wanted[i] = -1.0 if ratio == step else 1.0
            staying = without(wanted, count, active, room, multipliers, pulls, gram, factor, forward)
            if staying == count:  # not numbers
                return False, z, active[:0], multipliers[:0], np.inf
            count = staying
        for i in range(count):
            multipliers[i] = wanted[i]
    cost = 0.5 * dot(q, z, n)
    for k in range(count):
        cost -= 0.5 * multipliers[k] * b[active[k]]
    return found and np.isfinite(cost), z, active[:count], multipliers[:count], cost


def remembered(P: FloatArray, memory: FloatArray) -> bool:
    """Bring what is known of the cost matrix up to date; say whether it is positive definite."""
    if not np.array_equal(P, memory[COST]):
        memory[COST] = P
        factor, failed = dpotrf(P.T, clean=1)
        half = dtrtri(factor, overwrite_c=1)[0]
        np.dot(half, half.T, out=memory[INVERSE])
        if failed or not P.trace() < np.inf:
            memory[INVERSE] = np.nan
    return bool(np.isfinite(memory[INVERSE, 0, 0]))


def remembered_in_loops(P: FloatArray, memory: FloatArray) -> bool:
    """Do the same; without room for the inverse, the factor serves."""
    n, same = len(P), True
    for i in range(n):
        for j in range(n):
            same &= P[i, j] == memory[COST, i, j]
        if not same:
            break
    if not same:
        for i in range(n):
            for j in range(n):
                memory[COST, i, j] = P[i, j]
        for i in range(n):
            if not factor_row(P, memory[FACTOR], i, 0.0):
                memory[FACTOR, 0, 0] = np.nan
                return False
        if len(memory) > INVERSE:
            unit = np.empty(n)
            for i in range(n):
                for j in range(n):
                    unit[j] = 1.0 if i == j else 0.0
                by_factor(memory[FACTOR], unit, memory[INVERSE, i])
    return bool(np.isfinite(memory[FACTOR, 0, 0]))


def with_rows(
    A: FloatArray,
    b: FloatArray,
    free: FloatArray,
    inverse: FloatArray,
    active: IntArray,
    room: FloatArray,
    pulls: FloatArray,
    gram: FloatArray,
    entering: IntArray,
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return what is kept of the active rows with more among them."""
    count, normals = len(active), A[entering]
    more = np.concatenate((pulls, normals @ inverse))
    larger = np.empty((len(more), len(more)))
    larger[:count, :count] = gram
    larger[count:] = normals @ more.T
    larger[:count, count:] = larger[count:, :count].T
    room = np.concatenate((room, normals @ free - b[entering]))
    return np.concatenate((active, entering)), room, more, larger


def broken(over: FloatArray) -> IntArray:
    """Return the rows that are broken more than their neighbours, most broken ones first."""
    rows = np.flatnonzero(over > KEPT)
    if len(rows) > 1:
        edged = np.concatenate((over, (-np.inf,)))  # its end stands before the first row, too
        here = over[rows]
        rows = rows[(here >= edged[rows - 1]) & (here > edged[rows + 1])]
        rows = rows[np.argsort(-over[rows], kind="stable")[:AT_ONCE]]
    return rows


def solved(matrix: FloatArray, right: FloatArray) -> tuple[FloatArray, bool]:
    """Return ``x`` with ``matrix x = right``, and whether rows of the matrix depend on each other."""
    if len(right) == 0:
        return right, False
    factor, x, failed = dposv(matrix, right)
    return x, bool(failed != 0 or factor.diagonal().min() ** 2 <= FLAT)


def chosen_rows(over: FloatArray, most: int, rows: IntArray) -> int:
    """Write the rows that :func:`broken` returns, in its order; return how many."""
    count, last = 0, len(over) - 1
    for i in range(last + 1):
        v = over[i]
        if v > KEPT and (i == 0 or v >= over[i - 1]) and (i == last or not over[i + 1] >= v):
            if count == most and v <= over[rows[count - 1]]:
                continue
            count = min(count + 1, most)
            k = count - 1
            while k > 0 and over[rows[k - 1]] < v:
                rows[k] = rows[k - 1]
                k -= 1
            rows[k] = i
    return count


def tried(
    memory: FloatArray,
    normal: FloatArray,
    k: int,
    pulls: FloatArray,
    gram: FloatArray,
    factor: FloatArray,
    room: FloatArray,
    forward: FloatArray,
) -> bool:
    """Write what is kept of an active row as the k-th; say whether it does not depend on those before."""
    pulled(memory, normal, pulls[k])
    for j in range(k + 1):
        gram[k, j] = dot(normal, pulls[j], len(normal))
    independent = factor_row(gram, factor, k, FLAT)
    forward[k] = (room[k] - dot(factor[k], forward, k)) * factor[k, k]
    return independent


def without(
    wanted: FloatArray,
    count: int,
    active: IntArray,
    room: FloatArray,
    multipliers: FloatArray,
    pulls: FloatArray,
    gram: FloatArray,
    factor: FloatArray,
    forward: FloatArray,
) -> int:
    """Take the rows out whose wanted multipliers are negative; return how many stay."""
    kept, first = 0, count
    for i in range(count):
        if wanted[i] < 0.0:
            first = min(first, i)
            continue
        if kept < i:
            active[kept], room[kept], multipliers[kept] = active[i], room[i], multipliers[i]
            for j in range(pulls.shape[1]):
                pulls[kept, j] = pulls[i, j]
            column = 0
            for j in range(i + 1):
                if not wanted[j] < 0.0:
                    gram[kept, column] = gram[i, j]
                    column += 1
        kept += 1
    for k in range(first, kept):
        factor_row(gram, factor, k, FLAT)
        forward[k] = (room[k] - dot(factor[k], forward, k)) * factor[k, k]
    return kept


def factor_row(matrix: FloatArray, factor: FloatArray, k: int, least: float) -> bool:
    """Write row k of Cholesky's factor, its diagonal inverted; say whether its square exceeds a least one."""
    rest = matrix[k, k]
    for j in range(k):
        value = (matrix[k, j] - dot(factor[k], factor[j], j)) * factor[j, j]
        factor[k, j] = value
        rest -= value * value
    possible = least < rest < np.inf
    factor[k, k] = 1.0 / np.sqrt(rest) if possible else np.nan
    return bool(possible)


def solve_back(factor: FloatArray, right: FloatArray, x: FloatArray, count: int) -> bool:
    """Write ``x`` with ``factor' x = right``; say whether any of it is negative."""
    negative = False
    for i in range(count):
        x[i] = right[i]
    for i in range(count - 1, -1, -1):
        x[i] *= factor[i, i]
        negative |= x[i] < 0.0
        for j in range(i):
            x[j] -= x[i] * factor[i, j]
    return bool(negative)


def pulled(memory: FloatArray, normal: FloatArray, pull: FloatArray) -> None:
    """Write the inverse of the cost matrix times a vector."""
    n = len(normal)
    if len(memory) == INVERSE:
        by_factor(memory[FACTOR], normal, pull)
        return
    for i in range(n):
        pull[i] = 0.0
    for j in range(n):
        # Bounds and slacks have few coefficients.
        if normal[j] != 0.0:
            for i in range(n):
                pull[i] += normal[j] * memory[INVERSE, j, i]


def by_factor(factor: FloatArray, normal: FloatArray, pull: FloatArray) -> None:
    """Do the same with the factor."""
    for i in range(len(normal)):
        pull[i] = (normal[i] - dot(factor[i], pull, i)) * factor[i, i]
    solve_back(factor, pull, pull, len(normal))


def dot(first: FloatArray, second: FloatArray, count: int) -> float:
    """Return the product of two vectors' heads."""
    total = 0.0
    for i in range(count):
        total += first[i] * second[i]
    return total
