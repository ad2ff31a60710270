"""The solution of a quadratic program, and the certificate that it is one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem

FEASIBLE = 1e-3
"""Largest violation of a row or bound that a solution may have, in the row's own unit."""
STATIONARY = 1e-3
"""Largest component of the Lagrangian's gradient, relative to the largest of the terms it is the sum of."""
CLOSED = 1e-3
"""Largest duality gap, relative to the largest of the terms it is the sum of."""


class Rows(NamedTuple):
    """The rows of a problem that have a bound."""

    numbers: NDArray[np.intp]
    """Which rows these are, shape (k,)."""
    G: FloatArray
    h: FloatArray


class Certificate(NamedTuple):
    """How far a point and its multipliers are from meeting the optimality conditions; 0 at an optimum.

    Notes
    -----
    The definitions of [Caron2022]_, with multipliers of the wrong sign, or of bounds that do not exist, taken
    as 0 first. Dual residual and gap are divided by the largest of their terms, or by 1 if that is larger:
    weights of 100 make larger gradients than weights of 1.
    """

    primal_residual: float
    """Largest violation of any row or bound, in the row's own unit."""
    dual_residual: float
    """Relative."""
    duality_gap: float
    """Relative."""

    def complaint(self) -> str:
        """Return what is not within its tolerance, as a text; empty when everything is.

        >>> Certificate(0.0, 0.2, 0.0).complaint()
        'dual residual 0.2 above 0.001'
        """
        held = (
            ("primal residual", self.primal_residual, FEASIBLE),
            ("dual residual", self.dual_residual, STATIONARY),
            ("duality gap", self.duality_gap, CLOSED),
        )
        # Comparing the other way round would let NaN through.
        missed = [f"{name} {value:.3g} above {most:g}" for name, value, most in held if not value <= most]
        return ", ".join(missed)


NOTHING = Certificate(np.inf, np.inf, np.inf)
"""Of no point at all."""


class Solution(NamedTuple):
    """What a solver found. Only where ``solved`` may it be used: its certificate holds."""

    z: FloatArray
    """Variables, shape (n,); zeros where it is not solved."""
    solved: bool
    status: str
    """``solved``, or why not."""
    cost: float
    """Objective at ``z``; inf where it is not solved."""
    certificate: Certificate
    rows: Rows
    """The rows that were bounded."""
    multipliers: FloatArray
    """Of those, non-negative."""
    bound_multipliers: FloatArray
    """Of the variables: positive at the upper, negative at the lower bound, shape (n,)."""


def certify(problem: Problem, rows: Rows, z: FloatArray, y: FloatArray, box: FloatArray) -> Solution:
    """Return a point as a solution, which is ``solved`` only if it is proven to be one.

    Parameters
    ----------
    problem
        What was to be solved.
    rows
        Its rows with a bound, k of them.
    z
        The point, shape (n,).
    y, box
        Multipliers of rows and variables as a solver gives them, shapes (k,) and (n,).
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
        # Unlike max(), these do not overlook NaN.
        primal_residual=float(np.maximum.reduce(over, initial=0.0)),
        dual_residual=float(np.maximum.reduce(steepest) / max(1.0, np.maximum.reduce(largest, axis=None))),
        duality_gap=abs(sum(products)) / max(1.0, *map(abs, products)),
    )
    complaint = certificate.complaint()
    if complaint:
        return unsolved(problem, complaint, certificate)
    return Solution(z, True, "solved", 0.5 * products[0] + products[1], certificate, rows, y, box)


def unsolved(problem: Problem, status: str, certificate: Certificate = NOTHING) -> Solution:
    """Return that there is no solution, and why; what a solver may have found is not in it."""
    n, none = len(problem.q), Rows(np.empty(0, np.intp), np.empty((0, len(problem.q))), np.empty(0))
    return Solution(np.zeros(n), False, status, np.inf, certificate, none, np.empty(0), np.zeros(n))
