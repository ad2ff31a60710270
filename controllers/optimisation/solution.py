"""The solution of a quadratic program, and the certificate that proves it to be one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem

FEASIBLE = 1e-3
"""Largest violation of a row or bound that a solution may have, in the row's own unit."""
STATIONARY = 1e-3
"""Largest component of the Lagrangian's gradient, relative to the largest of its terms."""
CLOSED = 1e-3
"""Largest duality gap, relative to the largest of its terms."""


class Rows(NamedTuple):
    """The rows of a problem that have bounds."""

    numbers: NDArray[np.intp]
    """Indices of these rows in the problem, shape (k,)."""
    G: FloatArray
    h: FloatArray


class Certificate(NamedTuple):
    """How far a point and its multipliers are from meeting the optimality conditions; 0 at an optimum.

    Notes
    -----
    The definitions are those of [Caron2022]_, after multipliers of the wrong sign, or of bounds that do not
    exist, have been set to 0. Dual residual and gap are divided by the largest of their terms, or by 1 if
    that is larger, because weights of 100 make larger gradients than weights of 1.
    """

    primal_residual: float
    """Largest violation of any row or bound, in the row's own unit."""
    dual_residual: float
    """Relative largest component of the Lagrangian's gradient."""
    duality_gap: float
    """Relative duality gap."""

    def complaint(self) -> str:
        """Return which conditions exceed their tolerances, as text; empty if none does.

        >>> Certificate(0.0, 0.2, 0.0).complaint()
        'dual residual 0.2 above 0.001'
        """
        held = (
            ("primal residual", self.primal_residual, FEASIBLE),
            ("dual residual", self.dual_residual, STATIONARY),
            ("duality gap", self.duality_gap, CLOSED),
        )
        # The reverse comparison would let NaN through.
        missed = [f"{name} {value:.3g} above {most:g}" for name, value, most in held if not value <= most]
        return ", ".join(missed)


NOTHING = Certificate(np.inf, np.inf, np.inf)
"""Certificate without any point."""


class Solution(NamedTuple):
    """What a solver found. It may only be used if ``solved``, which means that its certificate holds."""

    z: FloatArray
    """Variables, shape (n,); zeros if not solved."""
    solved: bool
    status: str
    """``solved``, or why not."""
    cost: float
    """Objective at ``z``; inf if not solved."""
    certificate: Certificate
    rows: Rows
    """The rows that have bounds."""
    multipliers: FloatArray
    """Multipliers of these rows, non-negative, shape (k,)."""
    bound_multipliers: FloatArray
    """Multipliers of variables' bounds: positive at the upper, negative at the lower bound, shape (n,)."""


def certify(problem: Problem, rows: Rows, z: FloatArray, y: FloatArray, box: FloatArray) -> Solution:
    """Return a point as a solution, which is ``solved`` only if its certificate holds.

    Parameters
    ----------
    problem
        The problem to solve.
    rows
        Its k rows with bounds.
    z
        The point, shape (n,).
    y, box
        Multipliers of rows and variables as the solver gives them, shapes (k,) and (n,).
    """
    y = np.maximum(y, 0.0)
    limits = np.where(box > 0.0, problem.upper, problem.lower)
    there = np.abs(limits) != np.inf
    limits, box = np.where(there, limits, 0.0), np.where(there, box, 0.0)
    Pz, pull = problem.P @ z, y @ rows.G
    terms = np.array((Pz, problem.q, pull, box))
    products = (float(Pz @ z), float(problem.q @ z), float(rows.h @ y), float(limits @ box))
    over = np.concatenate((rows.G @ z - rows.h, problem.lower - z, z - problem.upper))
    steepest, largest = np.abs(np.add.reduce(terms)), np.abs(terms)
    certificate = Certificate(
        # Unlike max(), these reductions propagate NaN.
        primal_residual=float(np.maximum.reduce(over, initial=0.0)),
        dual_residual=float(np.maximum.reduce(steepest) / max(1.0, np.maximum.reduce(largest, axis=None))),
        duality_gap=abs(sum(products)) / max(1.0, *map(abs, products)),
    )
    complaint = certificate.complaint()
    if complaint:
        return unsolved(problem, complaint, certificate)
    return Solution(z, True, "solved", 0.5 * products[0] + products[1], certificate, rows, y, box)


def unsolved(problem: Problem, status: str, certificate: Certificate = NOTHING) -> Solution:
    """Return a solution that says only that there is none, and why, without what a solver may have found."""
    n, none = len(problem.q), Rows(np.empty(0, np.intp), np.empty((0, len(problem.q))), np.empty(0))
    return Solution(np.zeros(n), False, status, np.inf, certificate, none, np.empty(0), np.zeros(n))
