"""Compares every other method with ours, paired by condition and seed, and tests our non-inferiority."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import binom
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.proportion import proportion_confint

from analysis.arrays import FloatArray
from analysis.statistics.paired import Comparison, compare_values, holm
from analysis.study.comparison_rows import pair_runs
from analysis.study.design import Condition, Study
from studies.methods.rows import Row

OURS = "vo_mpc"
MARGIN = 0.5
"""Margin of non-inferiority: preventable contacts per 100 entered encounters."""
ASSUMED = 0.001
"""Share of preventable contacts of both methods for which the power is stated."""
LEVEL = 0.05
"""One-sided level of significance."""
REST = 1e-9
"""Probability of more contacts than the sum for the power takes into account."""
CERTAIN = 0.99
"""Above this power, more encounters never again lower it to a level that matters."""


@dataclass(frozen=True, slots=True)
class Against:
    """A method compared with ours."""

    method: str
    delay: Comparison
    """The method's delay minus ours [s]."""
    delay_p: float | None
    """P value after Holm's correction over the methods; ``jerk_p`` likewise."""
    jerk: Comparison
    jerk_p: float | None
    excess: float | None
    """Our preventable contacts per 100 entered encounters, minus the method's."""
    bound: float | None
    """Upper bound of ``excess``, one-sided at 95 %."""

    @property
    def shown(self) -> bool:
        """Whether ours is shown to be non-inferior."""
        return self.bound is not None and self.bound < MARGIN


def against(study: Study, rows: Mapping[str, Row]) -> list[Against]:
    """Return the comparison of every other method with ours.

    Ours is shown to be non-inferior to *every* method if each bound is below the margin. A claim about all of
    them together needs no correction (intersection-union test).

    Parameters
    ----------
    study : the study, for the pairs
    rows : row of each label over all conditions
    """
    others = [label for label in rows if label != OURS]
    delays = [_paired(study, label, "ego_delay_mean_s") for label in others]
    jerks = [_paired(study, label, "p95_abs_jerk_mps3") for label in others]
    corrected = [holm([one.p_value for one in some]) for some in (delays, jerks)]
    ours, found = rows.get(OURS), []
    for label, delay, delay_p, jerk, jerk_p in zip(
        others, delays, corrected[0], jerks, corrected[1], strict=True
    ):
        row, excess, bound = rows[label], None, None
        if ours is not None and ours.encounters and row.encounters:
            excess = 100.0 * (ours.preventable / ours.encounters - row.preventable / row.encounters)
            counts = [np.array([float(one.preventable)]) for one in (ours, row)]
            bound = 100.0 * float(upper_bound(counts[0], counts[1], ours.encounters, row.encounters)[0])
        found.append(Against(label, delay, delay_p, jerk, jerk_p, excess, bound))
    return found


def differences(
    study: Study, conditions: Sequence[Condition], labels: Sequence[str]
) -> dict[tuple[str, str], str]:
    """Return each method's delay minus ours under each condition, as text, by condition and method.

    A star marks a difference that is significant at a false discovery rate of 5 % over all of them
    [BenjaminiHochberg1995]_.
    """
    found = {
        (one.condition_id, label): comparison
        for one in conditions
        for label in labels
        if label != OURS
        and (comparison := _paired(study, label, "ego_delay_mean_s", [one])).difference is not None
    }
    tested = [key for key, one in found.items() if one.p_value is not None]
    p_values = [found[key].p_value for key in tested]
    beyond = dict(zip(tested, multipletests(p_values, 0.05, "fdr_bh")[0], strict=True)) if tested else {}
    return {key: f"{one.difference:+.1f}{'*' if beyond.get(key) else ''}" for key, one in found.items()}


def upper_bound(
    ours: FloatArray, other: FloatArray, n_ours: int, n_other: int, level: float = LEVEL
) -> FloatArray:
    """Return the one-sided upper bound of the difference of two shares, ours minus the other's.

    Parameters
    ----------
    ours, other : events, of shapes that NumPy broadcasts
    n_ours, n_other : trials
    level : probability of a difference beyond the bound

    Notes
    -----
    Method 10 of [Newcombe1998]_, from Wilson's bounds of both shares. Without any event on either side, the
    bound is z^2 / (n + z^2). Trials count as independent, although those of one run are not entirely.

    Examples
    --------
    >>> float(upper_bound(np.array([0.0]), np.array([0.0]), 538, 10**9)[0].round(5))
    0.005
    """
    share, base = ours / n_ours, other / n_other
    highest = proportion_confint(ours, n_ours, alpha=2.0 * level, method="wilson")[1]
    lowest = proportion_confint(other, n_other, alpha=2.0 * level, method="wilson")[0]
    return np.asarray(share - base + np.hypot(highest - share, base - lowest))


def power(encounters: int, share: float) -> float:
    """Return the probability of showing non-inferiority if both methods have contacts with this probability.

    The result is exact, a sum over the contacts of both.

    Examples
    --------
    >>> power(100, 0.0), power(1000, 0.0)
    (0.0, 1.0)
    """
    if encounters == 0:
        return 0.0
    contacts = np.arange(float(binom.isf(REST, encounters, share)) + 1.0)
    probability = binom.pmf(contacts, encounters, share)
    shown = 100.0 * upper_bound(contacts[:, None], contacts[None, :], encounters, encounters) < MARGIN
    return float(probability @ shown @ probability)


def needed(share: float, wanted: float = 0.8) -> int:
    """Return how many encounters of each method are needed for the power, rounded up to 100.

    The power suffices for this and every larger number. Contacts are whole numbers, so that a few more
    encounters may lower it.

    Examples
    --------
    >>> needed(0.0)
    600
    """
    enough = 100
    for n in range(100, 100_000, 100):
        found = power(n, share)
        if found < wanted:
            enough = n + 100
        if found >= CERTAIN:
            break
    return enough


def _paired(study: Study, label: str, name: str, conditions: Sequence[Condition] | None = None) -> Comparison:
    pairs = [pair_runs(study, [one], OURS, label) for one in conditions or study.conditions]
    values = [
        (base.numbers[name], alt.numbers[name])
        for one in pairs
        for (base,), (alt,) in zip(one.base, one.alt, strict=True)
        if name in base.numbers and name in alt.numbers
    ]
    sides = np.array(values, dtype=float).reshape(-1, 2)
    return compare_values(sides[:, 0], sides[:, 1])
