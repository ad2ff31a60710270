"""Number of runs that a mean needs."""

from __future__ import annotations

import math

from scipy import stats

from analysis.statistics.intervals import LEVEL

MOST = 10_000_000
"""More runs than anybody makes; beyond it no number is given."""


def replications_needed(mean: float, deviation: float, precision: float = 0.10) -> int | None:
    """Return the number of runs for which the interval is the mean plus or minus a share of it.

    The smallest n >= 2 with t(0.975, n − 1) · s / sqrt(n) <= e · |mean|.

    Parameters
    ----------
    mean, deviation
        Mean and standard deviation s over the runs made so far.
    precision
        Share e of the mean.

    Returns
    -------
    ``None`` for a mean of zero, where no share of it can be reached.

    Notes
    -----
    The rule of [FHWA-TAT3]_ and its like, with the t quantile of the n that comes out. It takes the
    deviation so far for the true one.

    Examples
    --------
    >>> replications_needed(10.0, 2.0)
    18
    """
    if mean == 0.0:
        return None
    relative = abs(deviation / mean) / precision
    # The normal quantile is below every t quantile: the answer is not smaller than this.
    start = (float(stats.norm.ppf(0.5 + 0.5 * LEVEL)) * relative) ** 2
    if start > MOST:
        return None
    n = max(2, math.ceil(start))
    while float(stats.t.ppf(0.5 + 0.5 * LEVEL, n - 1)) * relative > math.sqrt(n):
        n += 1
    return n
