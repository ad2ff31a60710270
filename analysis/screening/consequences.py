"""Probability that pedestrians die if struck at the speeds from which the drivers at a crossing brake."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analysis.arrays import FloatArray

_LEAST = 1e-6


class Risks(NamedTuple):
    """Sums of the probabilities of death over encounters; arrays of shape (crossings, runs)."""

    total: FloatArray
    squares: FloatArray
    """Sum of the squared probabilities."""
    defined: FloatArray
    """Number of encounters in which the speed is defined."""

    def of(self, chosen: FloatArray) -> Risks:
        """Return the sums of some crossings."""
        return Risks(*(values[chosen] for values in self))


class Belief(NamedTuple):
    """How much weight a crossing's own mean has, depending on its number of encounters."""

    usual: float | FloatArray
    """Mean over all crossings; nan if no speed is defined anywhere."""
    half: float
    """Number of encounters at which a crossing's own mean and the usual mean weigh the same; inf if crossings
    do not differ by more than chance."""

    def of(self, total: FloatArray, defined: FloatArray) -> FloatArray:
        """Return the mean of each crossing, drawn towards the usual mean, which may be an array.

        Examples
        --------
        >>> Belief(0.1, 10.0).of(np.array([3.0, 0.0]), np.array([10.0, 0.0])).tolist()
        [0.2, 0.1]
        """
        if not np.isfinite(self.half):
            return np.asarray(np.broadcast_to(self.usual, np.shape(total)))
        return np.asarray((total + self.half * self.usual) / (defined + self.half))


def belief_in(risks: Risks) -> Belief:
    """Return how much weight the mean of a crossing has, from the spread within and between crossings.

    Notes
    -----
    The estimators of Bühlmann and Straub [BuhlmannGisler2005]_, chapter 4, where each encounter is one
    observation: k = s² / a, with s² the pooled variance within crossings and a the variance between them, 0
    if negative.
    """
    total, squares, n = (values.sum(axis=1) for values in risks)
    seen = n > 0.0
    total, squares, n = total[seen], squares[seen], n[seen]
    if not len(n):
        return Belief(np.nan, np.inf)
    everything = float(n.sum())
    usual = float(total.sum()) / everything
    freedom, size = everything - len(n), everything - float((n**2).sum()) / everything
    if freedom <= 0.0 or size <= 0.0:
        return Belief(usual, np.inf)
    within = max(float((squares - total**2 / n).sum()), 0.0) / freedom
    between = (float((n * (total / n - usual) ** 2).sum()) - (len(n) - 1) * within) / size
    # Without any spread within crossings, a single encounter has almost all the weight.
    return Belief(usual, max(within / between, _LEAST) if between > 0.0 else np.inf)
