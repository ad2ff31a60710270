"""Ranks of crossings with their intervals, and which are worse than the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import false_discovery_control, rankdata, ttest_1samp

from analysis.arrays import FloatArray
from analysis.screening.shrinkage import Prior, expected, fit
from analysis.statistics.ratios import contributions

RESAMPLES = 2000
_BLOCK = 1000


@dataclass(frozen=True, slots=True)
class Ranking:
    """Values of each crossing; nan for those that are not ranked."""

    rate: FloatArray
    """Expected conflicts for each pedestrian."""
    rank: FloatArray
    """1 for the highest rate; equal ones share the mean of their ranks."""
    rank_low: FloatArray
    """95 % interval by resampling runs; nan with a single run."""
    rank_high: FloatArray
    p_worse: FloatArray
    """Of a t-test over runs that the rate is not above that of all other ranked crossings, adjusted for
    their number; nan where it cannot be said."""


def rank(conflicts: FloatArray, pedestrians: FloatArray, least_pedestrians: float) -> Ranking:
    """Rank crossings by the expected conflicts for each pedestrian.

    Parameters
    ----------
    conflicts, pedestrians
        Shape (crossings, runs).
    least_pedestrians
        A crossing with fewer in all runs is not ranked.

    Notes
    -----
    The run is what is resampled and tested, since what happens within one is not independent. The
    prior's dispersion is that of all runs. P values are adjusted for false discoveries
    [BenjaminiHochberg1995]_.
    """
    ranked = pedestrians.sum(axis=1) >= max(least_pedestrians, 1.0)
    nothing = np.full(len(conflicts), np.nan)
    if not ranked.any():
        return Ranking(*(nothing.copy() for _ in range(5)))
    k, e = conflicts[ranked], pedestrians[ranked]
    prior = fit(k.sum(axis=1), e.sum(axis=1))
    rate = expected(k.sum(axis=1), e.sum(axis=1), prior)
    low, high = _rank_intervals(k, e, prior)
    p = _p_worse(k, e)

    def of_all(values: FloatArray) -> FloatArray:
        found = nothing.copy()
        found[ranked] = values
        return found

    return Ranking(of_all(rate), of_all(_ranks(rate)), of_all(low), of_all(high), of_all(p))


def _ranks(rates: FloatArray) -> FloatArray:
    return np.asarray(rankdata(-np.round(rates, 12), axis=0), dtype=np.float64)


def _rank_intervals(
    conflicts: FloatArray, exposure: FloatArray, prior: Prior
) -> tuple[FloatArray, FloatArray]:
    """Return the 2.5th and 97.5th percentile of each rank over resampled runs."""
    runs = conflicts.shape[1]
    if runs < 2:
        return np.full(len(conflicts), np.nan), np.full(len(conflicts), np.nan)
    # The same runs for every table with as many of them: the numbers are those of a repetition.
    drawn = np.random.default_rng(runs).multinomial(runs, np.full(runs, 1.0 / runs), RESAMPLES).T
    k, e = (conflicts @ drawn).T, (exposure @ drawn).T
    usual = k.sum(axis=1) / np.maximum(e.sum(axis=1), 1.0)
    # Ranks are halves of whole numbers: exact in few bytes, of which ten thousand crossings need many.
    ranks = np.empty((len(conflicts), RESAMPLES), dtype=np.float32)
    for number, mean in enumerate(usual.tolist()):
        ranks[:, number] = _ranks(expected(k[number], e[number], prior._replace(mean=mean)))
    ends = [
        np.percentile(ranks[at : at + _BLOCK].astype(np.float64), (2.5, 97.5), axis=1)
        for at in range(0, len(ranks), _BLOCK)
    ]
    low, high = np.concatenate(ends, axis=1)
    return low, high


def _p_worse(conflicts: FloatArray, exposure: FloatArray) -> FloatArray:
    all_conflicts, all_exposure = conflicts.sum(axis=0), exposure.sum(axis=0)
    found = np.array(
        [
            _p_of(own, walks, all_conflicts - own, all_exposure - walks)
            for own, walks in zip(conflicts, exposure, strict=True)
        ]
    )
    defined = np.isfinite(found)
    if defined.any():
        found[defined] = false_discovery_control(found[defined])
    return found


def _p_of(conflicts: FloatArray, exposure: FloatArray, others: FloatArray, walks: FloatArray) -> float:
    """Return the p of one crossing against all others together, as ratios of sums over runs."""
    if len(conflicts) < 2 or walks.sum() <= 0.0:
        return np.nan
    differences = contributions(conflicts, exposure) - contributions(others, walks)
    if np.ptp(differences) < 1e-12:
        return np.nan
    return float(ttest_1samp(differences, 0.0, alternative="greater").pvalue)
