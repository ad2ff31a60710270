"""An estimated parameter with its interval; means over road users."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from analysis.arrays import FloatArray

LEVEL = 0.95
RESAMPLES = 1999
SEED = 20250102
LEAST = 5
"""With fewer road users, there is no estimate."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """One parameter."""

    name: str
    unit: str
    value: float
    """The estimate; nan if it cannot be estimated."""
    low: float
    """95 % interval."""
    high: float
    n: int
    """Number of road users."""
    method: str
    """How it was estimated, or why it could not be."""

    @property
    def known(self) -> bool:
        """Whether there is a value."""
        return math.isfinite(self.value)


def undefined(name: str, unit: str, n: int, why: str) -> Estimate:
    """Return a parameter that cannot be estimated."""
    return Estimate(name, unit, math.nan, math.nan, math.nan, n, why)


def mean(name: str, unit: str, values: FloatArray) -> Estimate:
    """Return the mean of road users' values with Student's interval.

    Examples
    --------
    >>> found = mean("walking_speed", "m/s", np.array([1.0, 1.2, 1.4, 1.6, 1.8]))
    >>> round(found.value, 3), round(found.low, 3), round(found.high, 3)
    (1.4, 1.007, 1.793)
    """
    values = values[np.isfinite(values)]
    if len(values) < LEAST:
        return undefined(name, unit, len(values), f"{len(values)} road users")
    low, high = values.min(), values.max()
    if low < high:  # of equal values, the interval has no width
        low, high = stats.t.interval(LEVEL, len(values) - 1, np.mean(values), stats.sem(values))
    return Estimate(
        name, unit, float(values.mean()), float(low), float(high), len(values), "mean, Student's t"
    )


def spread(name: str, unit: str, values: FloatArray) -> Estimate:
    """Return the standard deviation of road users' values with the chi-squared interval."""
    values = values[np.isfinite(values)]
    count = len(values)
    if count < LEAST:
        return undefined(name, unit, count, f"{count} road users")
    variance = float(values.var(ddof=1))
    quantiles = np.asarray(stats.chi2.ppf([0.5 + 0.5 * LEVEL, 0.5 - 0.5 * LEVEL], count - 1))
    ends = np.sqrt((count - 1) * variance / quantiles)
    return Estimate(
        name,
        unit,
        math.sqrt(variance),
        float(ends[0]),
        float(ends[1]),
        count,
        "standard deviation, chi-squared",
    )


def median(name: str, unit: str, values: FloatArray) -> Estimate:
    """Return the median of road users' values with its bootstrap interval."""
    values = values[np.isfinite(values)]
    if len(values) < LEAST:
        return undefined(name, unit, len(values), f"{len(values)} road users")
    found = stats.bootstrap(
        (values,),
        np.median,
        n_resamples=RESAMPLES,
        method="percentile",
        vectorized=True,
        rng=np.random.default_rng(SEED),
    ).confidence_interval
    return Estimate(
        name,
        unit,
        float(np.median(values)),
        float(found.low),
        float(found.high),
        len(values),
        "median, bootstrap",
    )
