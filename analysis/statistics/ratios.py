"""Shares and rates over runs: the ratio of sums, with one contribution from each run."""

from __future__ import annotations

import numpy as np

from analysis.arrays import FloatArray


def contributions(numerators: FloatArray, denominators: FloatArray) -> FloatArray:
    """Return what each run contributes to R = Σ y / Σ x; their mean is R.

    u_i = R + (y_i − R x_i) / mean(x). The values are not the ratios of single runs, which would give a run
    with two encounters the same weight as one with fifty. To first order, their spread is that of R. It is
    the spread between runs, so encounters of one run may depend on each other.

    Parameters
    ----------
    numerators, denominators
        y and x of each run, shape (n,).

    Raises
    ------
    ValueError
        When no run has a positive denominator.

    Notes
    -----
    The linearised ratio estimator of [Cochran1977]_, chapter 6, with each run as one cluster. A mean of
    single values is the case x = 1.

    Examples
    --------
    >>> contributions(np.array([1.0, 3.0]), np.array([10.0, 10.0])).round(6).tolist()
    [0.1, 0.3]
    """
    total = float(denominators.sum())
    if total <= 0.0:
        raise ValueError("no run has a positive denominator")
    ratio = float(numerators.sum()) / total
    return np.asarray(ratio + (numerators - ratio * denominators) * (len(denominators) / total))
