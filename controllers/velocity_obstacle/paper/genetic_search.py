"""pymoo's genetic algorithm for real numbers, on whole arrays.

pymoo's own loop keeps an object for each individual, which takes longer than evaluating the plans. Here, its
crossover and mutation are called directly with its defaults, and make the same choices.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from controllers.arrays import FloatArray, IntArray

CROSSED, EACH_CROSSED, EXCHANGED, NEAR_PARENTS = 0.9, 0.5, 0.5, 15.0
"""Simulated binary crossover: shares of pairs crossed, of their genes crossed, and of these exchanged, and
distribution index."""
MUTATED, OFTEN, NEAR_ITSELF = 0.9, 0.5, 20.0
"""Polynomial mutation: share of children mutated, largest share of their genes (otherwise one gene on
average), and distribution index."""


Value = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Function from genes, shape (n, g), to costs and to violations, which count first, shape (n,) each."""


def search(
    first: FloatArray, value: Value, low: FloatArray, high: FloatArray, generations: int, seed: int
) -> FloatArray:
    """Return the last generation, the best one first, shape (n, g).

    The better half of parents and children survives.

    Parameters
    ----------
    first
        The first generation, shape (n, g).
    value
        Function to minimise.
    low, high
        Bounds of the genes, shape (g,).
    generations
        Number of generations, including the first.
    seed
        Seed of all random numbers.

    Raises
    ------
    ImportError
        If pymoo is not installed.
    """
    breeding = _Breeding(low, high, np.random.default_rng(seed))
    genes, (cost, short) = first, value(first)
    for _ in range(generations - 1):
        born = breeding.children(genes, cost, short)
        born_cost, born_short = value(born)
        cost, short = np.append(cost, born_cost), np.append(short, born_short)
        fittest = np.lexsort((cost, short))[: len(first)]
        genes, cost, short = np.concatenate((genes, born))[fittest], cost[fittest], short[fittest]
    return genes[np.lexsort((cost, short))]


class _Breeding:
    """Makes children of a population; bounds as for :func:`search`."""

    def __init__(self, low: FloatArray, high: FloatArray, drawn: np.random.Generator) -> None:
        # pymoo takes a second to load, and only this solver needs it.
        from pymoo.operators.crossover.sbx import cross_sbx
        from pymoo.operators.mutation.pm import mut_pm

        self._low, self._high, self._drawn = low, high, drawn
        self._cross: Callable[..., FloatArray] = cross_sbx
        self._mutate: Callable[..., FloatArray] = mut_pm

    def children(self, genes: FloatArray, cost: FloatArray, short: FloatArray) -> FloatArray:
        """Return as many children as there are parents."""
        count, pairs = len(genes), math.ceil(len(genes) / 2)
        rounds = math.ceil(4 * pairs / count)
        drawn = np.concatenate([self._drawn.permutation(count) for _ in range(rounds)])[: 4 * pairs]
        chosen = self._better(drawn.reshape(-1, 2), cost, short).reshape(pairs, 2)
        return self._mutated(self._crossed(genes[chosen.T]))[:count]

    def _better(self, two: IntArray, cost: FloatArray, short: FloatArray) -> IntArray:
        """Return the better one of each pair, shape (n,); of equal ones, a random one."""
        counts = np.where((short[two] > 0.0).any(axis=1, keepdims=True), short[two], cost[two])
        better = two[np.arange(len(two)), np.argmin(counts, axis=1)]
        for tie in np.flatnonzero(counts[:, 0] == counts[:, 1]):
            better[tie] = self._drawn.choice(two[tie])
        return np.asarray(better)

    def _crossed(self, parents: FloatArray) -> FloatArray:
        """Return the children of pairs of parents, from shape (2, p, g) to (2 p, g)."""
        each = (parents.shape[1], 1)
        crossed = self._drawn.random(each) < CROSSED
        self._drawn.random(each)  # pymoo draws here which pairs exchange genes: all of them
        children = self._cross(
            parents,
            self._low,
            self._high,
            np.full(each, NEAR_PARENTS),
            np.full(each, EACH_CROSSED),
            np.full(each, EXCHANGED),
            random_state=self._drawn,
        )
        return np.where(crossed, children, parents).reshape(-1, parents.shape[2])

    def _mutated(self, children: FloatArray) -> FloatArray:
        count, size = children.shape
        share = np.full(count, min(OFTEN, 1.0 / size))
        mutants = self._mutate(
            children,
            self._low,
            self._high,
            np.full(count, NEAR_ITSELF),
            share,
            at_least_once=False,
            random_state=self._drawn,
        )
        mutated = self._drawn.random((count, 1)) <= MUTATED
        return np.where(mutated, mutants, children)
