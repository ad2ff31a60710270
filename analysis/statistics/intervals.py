"""95 % intervals of means, shares, rates and percentiles; the run is the unit of replication."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from statsmodels.stats.rates import confint_poisson

from analysis.arrays import FloatArray

LEVEL = 0.95
BOOTSTRAP_SEED = 20250101
"""Seed for resampling runs; a constant, so that the same runs give the same interval."""
BOOTSTRAP_RESAMPLES = 999
_CELLS = 4_000_000
"""Largest number of resamples times values held in memory at once."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A two-sided 95 % interval and the method that gave it."""

    low: float
    high: float
    method: str


def all_equal(values: FloatArray) -> bool:
    """Return whether the values differ by no more than rounding."""
    return bool(np.ptp(values) <= 1e-12 * np.max(np.abs(values), initial=0.0)) if len(values) else True


def mean_interval(
    values: FloatArray, minimum: float | None = None, maximum: float | None = None
) -> Interval | None:
    """Return Student's t interval of a mean, or ``None`` for fewer than two or for equal values.

    It is mean ± t(0.975, n − 1) · sd / sqrt(n), cut at the bounds of the quantity.

    Parameters
    ----------
    values
        One value for each independent unit, shape (n,).
    minimum, maximum
        Bounds of the quantity.

    Examples
    --------
    >>> interval = mean_interval(np.array([1.0, 2.0, 3.0]))
    >>> round(interval.low, 3), round(interval.high, 3)
    (-0.484, 4.484)
    """
    if len(values) < 2 or all_equal(values):
        return None
    low, high = stats.t.interval(LEVEL, len(values) - 1, np.mean(values), stats.sem(values))
    if minimum is not None:
        low = max(low, minimum)
    if maximum is not None:
        high = min(high, maximum)
    return Interval(float(low), float(high), "t")


def share_interval(events: int, trials: int) -> Interval | None:
    """Return the exact interval of a share, or ``None`` without trials.

    Notes
    -----
    [ClopperPearson1934]_; exact only for independent trials.

    Examples
    --------
    >>> round(share_interval(0, 10).high, 4)
    0.3085
    """
    if trials == 0:
        return None
    found = stats.binomtest(events, trials).proportion_ci(LEVEL, method="exact")
    return Interval(float(found.low), float(found.high), "clopper_pearson")


def share_upper_bound(events: int, trials: int) -> float | None:
    """Return the one-sided exact 95 % upper bound of a share, or ``None`` without trials.

    It is about 3 / n for no event in n trials.

    Examples
    --------
    >>> round(share_upper_bound(0, 300), 4)
    0.0099
    """
    if trials == 0:
        return None
    test = stats.binomtest(events, trials, alternative="less")
    return float(test.proportion_ci(LEVEL, method="exact").high)


def share_lower_bound(events: int, trials: int) -> float | None:
    """Return the one-sided exact 95 % lower bound of a share, or ``None`` without trials.

    Examples
    --------
    >>> round(share_lower_bound(300, 300), 4)
    0.9901
    """
    if trials == 0:
        return None
    test = stats.binomtest(events, trials, alternative="greater")
    return float(test.proportion_ci(LEVEL, method="exact").low)


def rate_interval(events: int, exposure: float) -> Interval | None:
    """Return the exact interval of a rate of events, or ``None`` without exposure.

    Parameters
    ----------
    events
        Number of events.
    exposure
        What the events are counted over, for instance hours [h]; the rate is per unit of it.

    Notes
    -----
    [Garwood1936]_; exact only for events that occur independently of each other.

    Examples
    --------
    >>> round(rate_interval(0, 1.0).high, 2)
    3.69
    """
    if exposure <= 0.0:
        return None
    low, high = confint_poisson(events, exposure, method="exact-c", alpha=1.0 - LEVEL)
    return Interval(float(low), float(high), "poisson")


def rate_upper_bound(events: int, exposure: float) -> float | None:
    """Return the one-sided exact 95 % upper bound of a rate, or ``None`` without exposure.

    Examples
    --------
    >>> round(rate_upper_bound(0, 1.0), 4)
    2.9957
    """
    if exposure <= 0.0:
        return None
    _, high = confint_poisson(events, exposure, method="exact-c", alpha=2.0 * (1.0 - LEVEL))
    return float(high)


def rate_lower_bound(events: int, exposure: float) -> float | None:
    """Return the one-sided exact 95 % lower bound of a rate, or ``None`` without exposure.

    Examples
    --------
    >>> rate_lower_bound(0, 1.0)
    0.0
    """
    if exposure <= 0.0:
        return None
    low, _ = confint_poisson(events, exposure, method="exact-c", alpha=2.0 * (1.0 - LEVEL))
    return float(low)


def percentile_interval(groups: Sequence[FloatArray], percent: float) -> Interval | None:
    """Return the interval of a percentile over all groups' values, by resampling whole groups.

    Values of one group may depend on each other; groups may not. Percentiles are interpolated linearly.

    Parameters
    ----------
    groups
        The values of each group; empty groups do not count.
    percent
        Which percentile, 0 to 100.

    Returns
    -------
    ``None`` for fewer than two groups, or when all values are equal.
    """
    filled = [group for group in groups if len(group)]
    if len(filled) < 2:
        return None
    values = np.concatenate(filled)
    if all_equal(values):
        return None
    order = np.argsort(values, kind="stable")
    values = values[order]
    group_of = np.repeat(np.arange(len(filled)), [len(group) for group in filled])[order]

    def percentiles(chosen: NDArray[np.int64], axis: int) -> FloatArray:
        rows = np.moveaxis(chosen, axis, -1)
        flat = rows.reshape(-1, len(filled))
        times = np.stack([np.bincount(row, minlength=len(filled)) for row in flat])
        return _weighted_percentiles(values, times[:, group_of], percent).reshape(rows.shape[:-1])

    found = stats.bootstrap(
        (np.arange(len(filled)),),
        percentiles,
        n_resamples=BOOTSTRAP_RESAMPLES,
        batch=max(1, _CELLS // len(values)),
        vectorized=True,
        confidence_level=LEVEL,
        method="percentile",
        rng=np.random.default_rng(BOOTSTRAP_SEED),
    ).confidence_interval
    return Interval(float(found.low), float(found.high), "bootstrap")


def _weighted_percentiles(values: FloatArray, times: NDArray[np.int64], percent: float) -> FloatArray:
    """Return the percentile of the sorted values for each row of ``times``, how often each value occurs."""
    filled_up_to = np.cumsum(times, axis=1)
    place = (filled_up_to[:, -1] - 1) * percent / 100.0
    below = np.floor(place)
    lower = (filled_up_to <= below[:, None]).sum(axis=1)
    upper = (filled_up_to <= np.ceil(place)[:, None]).sum(axis=1)
    return np.asarray(values[lower] + (place - below) * (values[upper] - values[lower]))
