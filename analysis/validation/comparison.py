"""Compares real with simulated road users: the difference, its interval, and what the data could show."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from analysis.arrays import FloatArray, IntArray

RESAMPLES = 1999
SEED = 20250101
"""Seed of the resamples, constant so that the same tracks give the same interval."""
LEVEL = 0.95
POWER = 0.8
LEAST = 5
"""Quantities with fewer road users on a side are listed, but not compared."""
_SHOWN = float(stats.norm.ppf(0.5 + 0.5 * LEVEL) + stats.norm.ppf(POWER))


@dataclass(frozen=True, slots=True)
class Comparison:
    """One quantity of two groups of road users; undefined values are nan."""

    n_real: int
    n_simulated: int
    real: float
    """Mean of the real road users."""
    simulated: float
    real_sd: float
    simulated_sd: float
    difference: float
    """Simulated minus real."""
    low: float
    """95 % interval of the difference."""
    high: float
    effect: float
    """Difference in pooled standard deviations."""
    distance: float
    """Largest distance between the two distribution functions (Kolmogorov-Smirnov), 0 to 1."""
    detectable: float
    """Difference that such data would show in four of five cases."""
    verdict: str
    """``different``, ``indistinguishable`` or ``too few``."""


def compare(real: FloatArray, simulated: FloatArray, names: Sequence[str] | None = None) -> Comparison:
    """Compare the values of real and of simulated road users.

    The interval is the percentile bootstrap of the difference of means. Both groups are resampled, each road
    user as a whole with all its runs, because the same road user at the same time in another run is no
    independent evidence. The standard error is that of the resamples; ``detectable`` is 2.80 times that, for
    a two-sided test at 5 % with a power of 80 %.

    Parameters
    ----------
    real, simulated : one value for each road user (of each run), shapes (n,) and (m,)
    names : names of the simulated road users, of length m; ``None``: nobody occurs twice

    Examples
    --------
    >>> found = compare(np.arange(10.0), np.arange(10.0) + 20.0)
    >>> found.verdict, found.difference, found.distance
    ('different', 20.0, 1.0)
    """
    known = np.isfinite(simulated)
    users = np.arange(len(known)) if names is None else np.asarray(names)
    real, simulated, users = real[np.isfinite(real)], simulated[known], users[known]
    means = (_mean(real), _mean(simulated))
    sds = (_spread(real), _spread(simulated))
    difference = means[1] - means[0]
    if min(len(real), len(np.unique(users))) < LEAST:
        nothing = (np.nan, np.nan, np.nan, np.nan, np.nan)
        return Comparison(len(real), len(simulated), *means, *sds, difference, *nothing, "too few")
    pooled = float(np.sqrt(0.5 * (sds[0] ** 2 + sds[1] ** 2)))
    rng = np.random.default_rng(SEED)
    who = np.unique(users, return_inverse=True)[1]
    drawn = _means(simulated, who, rng) - _means(real, np.arange(len(real)), rng)
    low, high = np.quantile(drawn, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    same = low <= 0.0 <= high
    return Comparison(
        len(real),
        len(simulated),
        *means,
        *sds,
        difference,
        float(low),
        float(high),
        difference / pooled if pooled > 0.0 else np.nan,
        float(stats.ks_2samp(real, simulated, method="asymp").statistic),
        _SHOWN * float(drawn.std(ddof=1)),
        "indistinguishable" if same else "different",
    )


def _mean(values: FloatArray) -> float:
    return float(values.mean()) if len(values) else math.nan


def _spread(values: FloatArray) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else math.nan


def _means(values: FloatArray, who: IntArray, rng: np.random.Generator) -> FloatArray:
    """Return the means of resamples of road users, each with all its values, shape (RESAMPLES,)."""
    result = stats.bootstrap(
        (np.bincount(who, weights=values), np.bincount(who)),
        lambda total, number, axis=-1: total.sum(axis=axis) / number.sum(axis=axis),
        paired=True,
        n_resamples=RESAMPLES,
        vectorized=True,
        method="percentile",
        batch=200,
        rng=rng,
    )
    return np.asarray(result.bootstrap_distribution, dtype=np.float64)


def in_words(found: Comparison, unit: str) -> str:
    """Return the verdict as a sentence."""
    unit = "" if unit == "1" else f" {unit}"
    if found.verdict == "too few":
        return f"cannot be said: {found.n_real} real and {found.n_simulated} simulated road users"
    if found.verdict == "different":
        more = "higher" if found.difference > 0.0 else "lower"
        return (
            f"different: simulated {more} by {abs(found.difference):.2f}{unit} "
            f"({found.low:.2f} to {found.high:.2f}), {abs(found.effect):.1f} standard deviations"
        )
    return (
        f"indistinguishable with this much data; a difference of {found.detectable:.2f}{unit} "
        "would have been shown in 4 of 5 cases"
    )
