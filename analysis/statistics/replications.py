"""Number of runs needed for a mean of given precision."""

from __future__ import annotations

import math

from scipy import stats

from analysis.statistics.intervals import LEVEL

MOST = 10_000_000
"""No number is given beyond this, which is more runs than anyone makes."""


def replications_needed(mean: float, deviation: float, precision: float = 0.10) -> int | None:
    """Return the number of runs for which the interval is at most the mean plus or minus a share of it.

    It is the smallest n >= 2 with t(0.975, n − 1) · s / sqrt(n) <= e · |mean|.

    Parameters
    ----------
    mean, deviation
        Mean and standard deviation s over the runs made so far.
    precision
        Share e of the mean.

    Returns
    -------
    ``None`` for a mean of zero, where no share of it can be reached, and if more than ``MOST`` are needed.

    Notes
    -----
    The rule of [FHWA-TAT3]_ and similar guides, with the t quantile of the resulting n. It takes the
    deviation so far as the true one.

    Examples
    --------
    >>> replications_needed(10.0, 2.0)
    18
    """
    if mean == 0.0:
        return None
    relative = abs(deviation / mean) / precision
    # The normal quantile is below every t quantile, so the answer is at least this.
    start = (float(stats.norm.ppf(0.5 + 0.5 * LEVEL)) * relative) ** 2
    if start > MOST:
        return None
    n = max(2, math.ceil(start))
    while float(stats.t.ppf(0.5 + 0.5 * LEVEL, n - 1)) * relative > math.sqrt(n):
        n += 1
    return n
