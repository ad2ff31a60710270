"""The solution of a quadratic program, and the certificate that it is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.optimisation.problem import Problem

FloatArray = NDArray[np.float64]

FEASIBLE = 1e-3
"""Largest violation of a row or bound that a solution may have, in the row's own unit."""
STATIONARY = 1e-3
"""Largest component of the Lagrangian's gradient, relative to the largest of the terms it is the sum of."""
CLOSED = 1e-3
"""Largest duality gap, relative to the largest of the terms it is the sum of."""


@dataclass(frozen=True, slots=True)
class Certificate:
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


@dataclass(frozen=True, slots=True)
class Solution:
    """What a solver found. Only where ``solved`` may it be used: its certificate holds."""

    z: FloatArray
    """Variables, shape (n,); zeros where nothing was found."""
    solved: bool
    status: str
    """``solved``, or why not."""
    cost: float
    """Objective at ``z``; inf where nothing was found."""
    certificate: Certificate
    row_multipliers: FloatArray
    """Of the rows ``G z <= h``, non-negative, shape (m,)."""
    bound_multipliers: FloatArray
    """Of the variables: positive at the upper, negative at the lower bound, shape (n,)."""


def certify(problem: Problem, z: FloatArray, rows: FloatArray, bounds: FloatArray) -> Solution:
    """Return a point as a solution, which is ``solved`` only if it is proven to be one.

    Parameters
    ----------
    problem
        What was to be solved.
    z, rows, bounds
        Point and multipliers as a solver gives them, shapes (n,), (m,) and (n,).
    """
    upper = np.where(np.isfinite(problem.upper), np.maximum(bounds, 0.0), 0.0)
    lower = np.where(np.isfinite(problem.lower), np.minimum(bounds, 0.0), 0.0)
    rows = np.where(np.isfinite(problem.h), np.maximum(rows, 0.0), 0.0)
    bounds = upper + lower
    Pz, pulls = problem.P @ z, rows @ problem.G
    over = problem.G @ z - problem.h
    violated = max(over.max(initial=0.0), (problem.lower - z).max(), (z - problem.upper).max(), 0.0)
    gradient = np.stack((Pz, problem.q, pulls, bounds))
    at_bounds = _product(problem.upper, upper) + _product(problem.lower, lower)
    gap = np.array((z @ Pz, problem.q @ z, _product(problem.h, rows), at_bounds))
    certificate = Certificate(
        primal_residual=float(violated),
        dual_residual=float(np.abs(gradient.sum(axis=0)).max() / max(1.0, np.abs(gradient).max())),
        duality_gap=float(abs(gap.sum()) / max(1.0, np.abs(gap).max())),
    )
    complaint = certificate.complaint()
    cost = float(0.5 * gap[0] + gap[1])
    return Solution(z, not complaint, complaint or "solved", cost, certificate, rows, bounds)


def unsolved(problem: Problem, status: str) -> Solution:
    """Return that there is no solution, and why."""
    n, m = len(problem.q), len(problem.h)
    nothing = Certificate(np.inf, np.inf, np.inf)
    return Solution(np.zeros(n), False, status, np.inf, nothing, np.zeros(m), np.zeros(n))


def _product(limits: FloatArray, multipliers: FloatArray) -> float:
    """Return the sum of limits times multipliers, over those that bind; the others may be infinite."""
    binding = np.flatnonzero(multipliers)
    return float(limits[binding] @ multipliers[binding])
