"""Ranks of crossings with their intervals, and which are worse than the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import false_discovery_control, rankdata, ttest_1samp

from analysis.geometry import BoolArray, FloatArray
from analysis.screening.shrinkage import Prior, expected, fit
from analysis.statistics.ratios import contributions

RESAMPLES = 2000


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
    drawings = zip(k, e, usual.tolist(), strict=True)
    rates = np.column_stack(
        [expected(events, walks, prior._replace(mean=mean)) for events, walks, mean in drawings]
    )
    low, high = np.percentile(_ranks(rates), (2.5, 97.5), axis=1)
    return low, high


def _p_worse(conflicts: FloatArray, exposure: FloatArray) -> FloatArray:
    found = np.array([_p_of(conflicts, exposure, number) for number in range(len(conflicts))])
    defined = np.isfinite(found)
    if defined.any():
        found[defined] = false_discovery_control(found[defined])
    return found


def _p_of(conflicts: FloatArray, exposure: FloatArray, number: int) -> float:
    """Return the p of one crossing against all others, as ratios of sums over runs."""
    others: BoolArray = np.arange(len(conflicts)) != number
    rest = exposure[others].sum(axis=0)
    if conflicts.shape[1] < 2 or rest.sum() <= 0.0:
        return np.nan
    own = contributions(conflicts[number], exposure[number])
    differences = own - contributions(conflicts[others].sum(axis=0), rest)
    if np.ptp(differences) < 1e-12:
        return np.nan
    return float(ttest_1samp(differences, 0.0, alternative="greater").pvalue)
