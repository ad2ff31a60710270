"""NSGA-II over the final offset and the final speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray

Judge = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Genes, shape (n, 2) -> costs, shape (n, m), and violations, positive where violated, shape (n, k)."""


@dataclass(frozen=True, slots=True)
class Budget:
    """How long to search: population · generations candidates are evaluated, however long that takes."""

    population: int = 20
    generations: int = 10


@dataclass(frozen=True, slots=True)
class Front:
    """The candidates of the last population that keep all constraints and that no other one dominates."""

    genes: FloatArray
    """Shape (n, 2); n is 0 when nothing feasible was found."""
    costs: FloatArray
    """Shape (n, m)."""
    looked_at: int
    """Number of candidates evaluated."""


def search(
    judge: Judge,
    sizes: tuple[int, int],
    lower: FloatArray,
    upper: FloatArray,
    hints: FloatArray,
    budget: Budget,
    seed: int,
) -> Front:
    """Return the front that NSGA-II finds.

    Parameters
    ----------
    judge : returns what candidates cost, and which constraints they violate
    sizes : number of costs and of constraints
    lower, upper : bounds of the genes, shape (2,)
    hints : candidates to begin with, shape (h, 2); the rest of the first population is drawn uniformly
    budget : how long to search
    seed : seed of everything random

    Notes
    -----
    Section 4.2 of [Wu2023]_ names the algorithm but none of its settings.
    """
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    drawn = np.random.default_rng(seed).random((budget.population, len(lower)))
    first = lower + drawn * (upper - lower)
    first[: len(hints)] = np.clip(hints, lower, upper)[: budget.population]

    class Candidates(Problem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(n_var=len(lower), n_obj=sizes[0], n_ieq_constr=sizes[1], xl=lower, xu=upper)

        def _evaluate(self, genes: FloatArray, out: dict[str, FloatArray], *_: object, **__: object) -> None:
            out["F"], out["G"] = judge(genes)

    algorithm = NSGA2(pop_size=budget.population, sampling=first)
    found = minimize(Candidates(), algorithm, ("n_gen", budget.generations), seed=seed)
    genes = np.zeros((0, len(lower))) if found.X is None else np.atleast_2d(found.X)
    costs = np.zeros((0, sizes[0])) if found.F is None else np.atleast_2d(found.F)
    return Front(genes, costs, int(found.algorithm.evaluator.n_eval))
