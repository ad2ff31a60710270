"""Rates of rare events, drawn towards the usual rate for the exposure by empirical Bayes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.stats import nbinom

from analysis.arrays import FloatArray

LEAST_DISPERSION, MOST_DISPERSION = 1e-4, 1e2
START = 0.5
"""Dispersion at which the search begins."""


class Prior(NamedTuple):
    """Distribution of the rates of places: a gamma distribution."""

    mean: float | FloatArray
    """Events per unit of exposure."""
    dispersion: float
    """Squared coefficient of variation of the rates."""


def fit(events: FloatArray, exposure: FloatArray) -> Prior:
    """Return the prior under which the counts, then negative binomial, are most likely.

    Parameters
    ----------
    events, exposure
        Values of each place, shape (n,); places without exposure are left out.

    Raises
    ------
    ValueError
        If no place has exposure.

    Notes
    -----
    Hauer's empirical Bayes method as in the network screening of the Highway Safety Manual [HSM2010]_,
    with a safety performance function that is proportional to the exposure.

    Examples
    --------
    >>> round(fit(np.array([10.0, 10.0, 10.0]), np.array([100.0, 100.0, 100.0])).mean, 3)
    0.1
    """
    used = exposure > 0.0
    k, e = events[used], exposure[used]
    if not len(e):
        raise ValueError("no place has exposure")
    mean = float(k.sum() / e.sum())
    if mean == 0.0 or len(e) < 2:
        return Prior(mean, LEAST_DISPERSION)

    def unlikely(logs: FloatArray) -> float:
        rate, dispersion = np.exp(logs)
        size = 1.0 / dispersion
        return -float(nbinom.logpmf(k, size, size / (size + rate * e)).sum())

    low, high = np.log(LEAST_DISPERSION), np.log(MOST_DISPERSION)
    start = np.array([np.log(mean), np.log(START)])
    bounds = [(start[0] - 5.0, start[0] + 5.0), (low, high)]
    rate, dispersion = np.exp(minimize(unlikely, start, method="L-BFGS-B", bounds=bounds).x)
    return Prior(float(rate), float(dispersion))


def expected(events: FloatArray, exposure: FloatArray, prior: Prior) -> FloatArray:
    """Return the expected rate of each place, which lies between the rate counted there and the prior's mean.

    The prior's mean may be an array that broadcasts with the events.

    Examples
    --------
    >>> expected(np.array([5.0, 0.0]), np.array([10.0, 0.0]), Prior(0.1, 1.0)).round(3).tolist()
    [0.3, 0.1]
    """
    size, mean = 1.0 / prior.dispersion, np.asarray(prior.mean)
    nothing = mean == 0.0
    rates = (size + events) / (size / np.where(nothing, 1.0, mean) + exposure)
    return np.asarray(np.where(nothing, 0.0, rates))
