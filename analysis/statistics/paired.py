"""Two alternatives on the same seeds: differences, their interval, a test and an effect size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats
from statsmodels.stats.contingency_tables import mcnemar

from analysis.arrays import FloatArray
from analysis.statistics.intervals import LEVEL, Interval, all_equal, mean_interval

SKEWED = 1.0
"""Above this absolute sample skewness of the differences, their ranks are tested instead of their mean."""
FEWEST_FOR_RANKS = 6
"""With fewer pairs than this, no rank test can reach a p of 0.05."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """An alternative against a base over n pairs; values that are undefined are ``None``."""

    pairs: int
    base_mean: float | None = None
    alt_mean: float | None = None
    difference: float | None = None
    """Alternative minus base."""
    deviation: float | None = None
    """Standard deviation of the pairs' differences."""
    interval: Interval | None = None
    correlation: float | None = None
    """Correlation of the pairs; at or below 0, common seeds have gained nothing."""
    test: str = "none"
    statistic: float | None = None
    p_value: float | None = None
    effect_size: float | None = None
    effect: str = ""
    status: str = "ok"
    """``ok``, ``no_pairs``, ``one_pair``, ``no_difference`` (all pairs equal) or
    ``constant_difference``."""


def compare_values(base: FloatArray, alt: FloatArray) -> Comparison:
    """Compare two alternatives by one value for each seed.

    The interval is Student's t of the mean difference. The test is the paired t test; Wilcoxon's signed
    ranks if there are at least ``FEWEST_FOR_RANKS`` pairs and the differences are skewed; the sign test if
    all differences are equal, because a t test would divide by zero then. The effect size is Cohen's d_z
    (mean over standard deviation of the differences) with the t test, and the matched-pairs rank-biserial
    correlation otherwise.

    Parameters
    ----------
    base, alt
        Values of the same seeds in the same order, shape (n,).

    Notes
    -----
    [Wilcoxon1945]_; differences within rounding of 0 are left out of the ranks, and differences within
    rounding of each other are ties.

    Examples
    --------
    >>> found = compare_values(np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 5.0]))
    >>> found.test, round(found.difference, 3), round(found.statistic, 3)
    ('paired_t', 1.333, 4.0)
    """
    n = len(base)
    if n == 0:
        return Comparison(0, status="no_pairs")
    differences = alt - base
    means = (float(base.mean()), float(alt.mean()), float(differences.mean()))
    if n == 1:
        return Comparison(1, *means, status="one_pair")
    correlation = _correlation(base, alt)
    scale = max(float(np.abs(base).max()), float(np.abs(alt).max()))
    if np.ptp(differences) <= 1e-12 * scale:
        if abs(means[2]) <= 1e-12 * scale:
            return Comparison(n, *means[:2], 0.0, 0.0, correlation=correlation, status="no_difference")
        sign = float(np.sign(means[2]))
        p = float(stats.binomtest(n, n).pvalue)
        return Comparison(
            n, *means, 0.0, None, correlation, "sign", n, p, sign, "rank_biserial", "constant_difference"
        )
    deviation = float(differences.std(ddof=1))
    interval = mean_interval(differences)
    if n >= FEWEST_FOR_RANKS and abs(float(stats.skew(differences, bias=False))) > SKEWED:
        # With zeros among many pairs, SciPy uses the normal distribution, however few pairs differ.
        moved = _without_rounding(differences, scale)
        both = stats.wilcoxon(moved)
        return Comparison(
            n,
            *means,
            deviation,
            interval,
            correlation,
            "wilcoxon",
            float(both.statistic),
            float(both.pvalue),
            _rank_biserial(moved),
            "rank_biserial",
        )
    t = stats.ttest_rel(alt, base)
    return Comparison(
        n,
        *means,
        deviation,
        interval,
        correlation,
        "paired_t",
        float(t.statistic),
        float(t.pvalue),
        means[2] / deviation,
        "cohen_dz",
    )


def compare_yes_no(base: FloatArray, alt: FloatArray) -> Comparison:
    """Compare two alternatives by yes (1) or no (0) for each seed.

    The test is McNemar's, exact: a sign test of the pairs that differ. The interval of the difference
    of the shares is the adjusted one of [AgrestiMin2005]_: with b pairs in which only the base says yes and c
    in which only the alternative does, half a pair is added to each of the four cells, and the interval is
    d ± z · sqrt((b + c + 1) − (c − b)^2 / (n + 2)) / (n + 2) with d = (c − b) / (n + 2). It has a width
    even if no pair differs.

    Notes
    -----
    [McNemar1947]_. The effect size is (c − b) / (c + b).

    Examples
    --------
    >>> found = compare_yes_no(np.array([1.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 0.0, 0.0]))
    >>> found.test, found.difference, found.p_value
    ('mcnemar', -0.75, 0.25)
    """
    n = len(base)
    if n == 0:
        return Comparison(0, status="no_pairs")
    means = (float(base.mean()), float(alt.mean()), float((alt - base).mean()))
    b, c = int(((base > 0) & (alt <= 0)).sum()), int(((base <= 0) & (alt > 0)).sum())
    z = float(stats.norm.ppf(0.5 + 0.5 * LEVEL))
    middle, half = (c - b) / (n + 2), z * np.sqrt((b + c + 1) - (c - b) ** 2 / (n + 2)) / (n + 2)
    interval = Interval(max(-1.0, middle - half), min(1.0, middle + half), "agresti_min")
    deviation = float((alt - base).std(ddof=1)) if n > 1 else None
    correlation = _correlation(base, alt) if n > 1 else None
    if b + c == 0:
        return Comparison(n, *means, deviation, interval, correlation, status="no_difference")
    both, neither = int(((base > 0) & (alt > 0)).sum()), int(((base <= 0) & (alt <= 0)).sum())
    found = mcnemar([[both, b], [c, neither]], exact=True)
    return Comparison(
        n,
        *means,
        deviation,
        interval,
        correlation,
        "mcnemar",
        float(found.statistic),
        float(found.pvalue),
        (c - b) / (c + b),
        "rank_biserial",
    )


def holm(p_values: Sequence[float | None]) -> list[float | None]:
    """Return the p values of one family after Holm's correction; undefined ones are not in the family.

    Notes
    -----
    [Holm1979]_: keeps the probability of any false finding in the family at 5 % or less, however the tests
    depend on each other.

    Examples
    --------
    >>> holm([0.01, None, 0.04])
    [0.02, None, 0.04]
    """
    # Not statsmodels' multipletests: it collects garbage at every call, which takes far longer than this.
    known = np.array([p for p in p_values if p is not None], dtype=np.float64)
    order = np.argsort(known)
    raised = np.maximum.accumulate(known[order] * np.arange(len(known), 0, -1))
    corrected = np.empty_like(known)
    corrected[order] = np.minimum(raised, 1.0)
    left = iter(corrected.tolist())
    return [None if p is None else next(left) for p in p_values]


def _correlation(base: FloatArray, alt: FloatArray) -> float | None:
    if len(base) < 3 or all_equal(base) or all_equal(alt):
        return None
    return float(np.clip(np.corrcoef(base, alt)[0, 1], -1.0, 1.0))


def _without_rounding(differences: FloatArray, scale: float) -> FloatArray:
    """Return the differences that exceed rounding, in units of ``scale``; ties among them are exact."""
    found = np.round(differences / scale, 13)
    return np.asarray(found[found != 0.0])


def _rank_biserial(moved: FloatArray) -> float:
    """Return (sum of positive ranks − sum of negative ranks) / sum of all ranks; no difference may be 0."""
    ranks = stats.rankdata(np.abs(moved))
    return float(np.sum(np.sign(moved) * ranks) / ranks.sum())
