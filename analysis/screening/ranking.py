"""Ranks crossings, with intervals of the ranks, and says which are worse than the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import false_discovery_control, rankdata, ttest_1samp

from analysis.arrays import FloatArray
from analysis.screening.consequences import Risks, belief_in
from analysis.screening.shrinkage import expected, fit
from analysis.statistics.ratios import contributions

RESAMPLES = 2000
_BLOCK = 1000
_AT_ONCE = 200_000
BY_RISK, BY_CONFLICTS = "risk", "conflicts"
RANK_BY = (BY_RISK, BY_CONFLICTS)
"""What a rank may follow: conflicts per pedestrian times the probability of death, or conflicts alone."""


@dataclass(frozen=True, slots=True)
class Counted:
    """Counts of events at crossings; arrays of shape (crossings, runs)."""

    conflicts: FloatArray
    pedestrians: FloatArray
    risks: Risks

    def of(self, chosen: FloatArray) -> Counted:
        """Return the counts of some crossings."""
        return Counted(self.conflicts[chosen], self.pedestrians[chosen], self.risks.of(chosen))


@dataclass(frozen=True, slots=True)
class Ranking:
    """Values of each crossing; nan for crossings that are not ranked."""

    rate: FloatArray
    """Expected conflicts per pedestrian."""
    p_fatal: FloatArray
    """Expected probability of death in a collision; also nan if no speed is known at any crossing."""
    ranks: Mapping[str, FloatArray]
    """Ranks for each of ``RANK_BY``: 1 for the highest value; equal values share the mean of their ranks."""
    by: str
    """The ranking to which interval and test belong."""
    rank_low: FloatArray
    """95 % interval of the rank by resampling runs; nan with a single run."""
    rank_high: FloatArray
    p_worse: FloatArray
    """P of a t-test over runs that the value is not above that of all other ranked crossings, adjusted for
    their number; nan if it is undefined."""

    @property
    def rank(self) -> FloatArray:
        """The rank that counts."""
        return self.ranks[self.by]


def rank(counted: Counted, least_pedestrians: float, by: str = BY_RISK) -> Ranking:
    """Rank crossings by expected conflicts per pedestrian and by their risk.

    Parameters
    ----------
    counted
        Counts of all crossings.
    least_pedestrians
        A crossing with fewer pedestrians in all runs is not ranked.
    by
        One of ``RANK_BY``, to which interval and test belong.

    Notes
    -----
    Risk is probability times consequence: the expected conflicts per pedestrian, times the expected
    probability of death in a collision at the speed from which drivers brake there. Weights of severity are
    usual in network screening [HSM2010]_, where they are the costs of crashes.

    Runs are resampled and tested, because events within a run are not independent. Dispersion and
    credibility are those of all runs. P values are adjusted for false discoveries [BenjaminiHochberg1995]_.
    """
    ranked = counted.pedestrians.sum(axis=1) >= max(least_pedestrians, 1.0)
    nothing = np.full(len(ranked), np.nan)

    def of_all(values: FloatArray) -> FloatArray:
        found = nothing.copy()
        found[ranked] = values
        return found

    if not ranked.any():
        return Ranking(nothing, nothing, dict.fromkeys(RANK_BY, nothing), by, nothing, nothing, nothing)
    own = counted.of(ranked)
    rates, p_fatal, low, high = _estimated(own, by)
    # If no speed is known, all crossings have the same unknown consequence.
    values = {BY_CONFLICTS: rates, BY_RISK: rates * np.where(np.isfinite(p_fatal), p_fatal, 1.0)}
    return Ranking(
        of_all(rates),
        of_all(p_fatal),
        {name: of_all(_ranks(values[name])) for name in RANK_BY},
        by,
        of_all(low),
        of_all(high),
        of_all(_p_worse(own, by)),
    )


def _ranks(values: FloatArray) -> FloatArray:
    return np.asarray(rankdata(-np.round(values, 12), axis=0), dtype=np.float64)


def _estimated(own: Counted, by: str) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return rates, probabilities of death, and both ends of the rank's interval."""
    k, e = own.conflicts, own.pedestrians
    prior, belief = fit(k.sum(axis=1), e.sum(axis=1)), belief_in(own.risks)
    deaths, met = own.risks.total, own.risks.defined
    rates = expected(k.sum(axis=1), e.sum(axis=1), prior)
    p_fatal = belief.of(deaths.sum(axis=1), met.sum(axis=1))
    runs = k.shape[1]
    if runs < 2:
        unknown = np.full(len(k), np.nan)
        return rates, p_fatal, unknown, unknown
    # The draws depend only on the number of runs, so that a repetition gives the same numbers.
    drawn = np.random.default_rng(runs).multinomial(runs, np.full(runs, 1.0 / runs), RESAMPLES).T
    # Ranks are halves of whole numbers, which 4 bytes hold exactly; ten thousand crossings need many of them.
    ranks = np.empty((len(k), RESAMPLES), dtype=np.float32)
    step = max(1, _AT_ONCE // len(k))
    for at in range(0, RESAMPLES, step):
        chosen = drawn[:, at : at + step].astype(np.float64)
        events, exposure = k @ chosen, e @ chosen
        usual = events.sum(axis=0) / np.maximum(exposure.sum(axis=0), 1.0)
        values = expected(events, exposure, prior._replace(mean=usual))
        if by == BY_RISK and met.any():
            some, seen = deaths @ chosen, met @ chosen
            around = some.sum(axis=0) / np.maximum(seen.sum(axis=0), 1.0)
            values = values * belief._replace(usual=around).of(some, seen)
        ranks[:, at : at + step] = _ranks(values)
    ends = [
        np.percentile(ranks[at : at + _BLOCK].astype(np.float64), (2.5, 97.5), axis=1)
        for at in range(0, len(ranks), _BLOCK)
    ]
    low, high = np.concatenate(ends, axis=1)
    return rates, p_fatal, low, high


def _p_worse(own: Counted, by: str) -> FloatArray:
    tables = [own.conflicts, own.pedestrians]
    if by == BY_RISK and own.risks.defined.any():
        tables += [own.risks.total, own.risks.defined]
    sums = [table.sum(axis=0) for table in tables]
    differences = np.array(
        [
            _difference(
                [table[i] for table in tables],
                [all_ - table[i] for all_, table in zip(sums, tables, strict=True)],
            )
            for i in range(len(own.conflicts))
        ]
    )
    found = np.full(len(differences), np.nan)
    varied = np.ptp(differences, axis=1) >= 1e-12  # false if they are undefined
    if varied.any():
        found[varied] = ttest_1samp(differences[varied], 0.0, axis=1, alternative="greater").pvalue
    defined = np.isfinite(found)
    if defined.any():
        found[defined] = false_discovery_control(found[defined])
    return found


def _difference(own: list[FloatArray], others: list[FloatArray]) -> FloatArray:
    """Return what each run contributes to the difference between one crossing and all others together."""
    if len(own[0]) < 2 or any(below.sum() <= 0.0 for side in (own, others) for below in side[1::2]):
        return np.full(len(own[0]), np.nan)
    return np.asarray(_product(own) - _product(others))


def _product(tables: list[FloatArray]) -> FloatArray:
    """Return what each run contributes to a ratio, or to the product of two, to first order."""
    first = contributions(tables[0], tables[1])
    if len(tables) == 2:
        return first
    second = contributions(tables[2], tables[3])
    return np.asarray(second.mean() * first + first.mean() * second - first.mean() * second.mean())
