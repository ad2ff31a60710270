"""Intervals, tests and numbers of replications against closed forms, textbook cases and other programs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from analysis.statistics import intervals
from analysis.statistics.intervals import (
    mean_interval,
    percentile_interval,
    rate_interval,
    rate_upper_bound,
    share_interval,
    share_upper_bound,
)
from analysis.statistics.paired import compare_values, compare_yes_no, holm
from analysis.statistics.ratios import contributions
from analysis.statistics.replications import replications_needed

# Student's sleep data: extra hours of sleep of ten patients under two drugs.
SLEEP_1 = np.array([0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0])
SLEEP_2 = np.array([1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4])


def pairs_of(both: int, only_base: int, only_alt: int, neither: int) -> tuple[np.ndarray, np.ndarray]:
    base = np.repeat([1.0, 1.0, 0.0, 0.0], [both, only_base, only_alt, neither])
    alt = np.repeat([1.0, 0.0, 1.0, 0.0], [both, only_base, only_alt, neither])
    return base, alt


# intervals


def test_the_interval_of_a_mean_is_that_of_the_sleep_data_in_the_textbook() -> None:
    interval = mean_interval(SLEEP_2 - SLEEP_1)
    assert interval is not None
    assert (interval.low, interval.high) == pytest.approx((0.7001142, 2.4598858), abs=1e-7)
    assert interval.method == "t"


def test_an_interval_ends_where_the_quantity_does() -> None:
    values = np.array([0.0, 0.0, 1.0])
    free, cut = mean_interval(values), mean_interval(values, 0.0, 1.0)
    assert free is not None
    assert cut is not None
    assert free.low < 0.0 < 1.0 < free.high
    assert (cut.low, cut.high) == (0.0, 1.0)


@pytest.mark.parametrize("values", [[], [3.0], [3.0, 3.0, 3.0], [0.1 + 0.2, 0.3]])
def test_one_value_and_equal_values_have_no_interval(values: list[float]) -> None:
    assert mean_interval(np.array(values)) is None


@pytest.mark.parametrize(("n", "upper"), [(10, 0.259), (30, 0.095), (100, 0.0295), (300, 0.0099)])
def test_no_event_in_n_trials_is_bounded_by_about_three_in_n(n: int, upper: float) -> None:
    bound = share_upper_bound(0, n)
    assert bound == pytest.approx(upper, abs=5e-4)
    assert bound == pytest.approx(1.0 - 0.05 ** (1.0 / n), rel=1e-9)


def test_the_interval_of_a_share_is_the_exact_one() -> None:
    # Mendel's peas, the example of R's binom.test: 682 of 925.
    interval = share_interval(682, 925)
    assert interval is not None
    assert (interval.low, interval.high) == pytest.approx((0.7076683, 0.7654066), abs=1e-6)
    none, every = share_interval(0, 10), share_interval(10, 10)
    assert none is not None
    assert every is not None
    assert (none.low, none.high) == pytest.approx((0.0, 1.0 - 0.025**0.1))
    assert (every.low, every.high) == pytest.approx((0.025**0.1, 1.0))


@pytest.mark.parametrize(
    ("events", "low", "high"),
    [(0, 0.0, 3.69), (1, 0.03, 5.57), (2, 0.24, 7.22), (5, 1.62, 11.67), (10, 4.80, 18.39), (20, 12.2, 30.9)],
)
def test_the_interval_of_a_count_is_the_one_of_the_tables(events: int, low: float, high: float) -> None:
    one = rate_interval(events, 1.0)
    assert one is not None
    assert (one.low, one.high) == pytest.approx((low, high), abs=0.05)
    four = rate_interval(events, 4.0)
    assert four is not None
    assert (four.low, four.high) == pytest.approx((one.low / 4.0, one.high / 4.0))


def test_a_rate_without_events_is_bounded_by_the_logarithm_of_20() -> None:
    assert rate_upper_bound(0, 2.0) == pytest.approx(np.log(20.0) / 2.0)


def test_without_trials_or_exposure_nothing_is_said() -> None:
    assert share_interval(0, 0) is None
    assert share_upper_bound(0, 0) is None
    assert rate_interval(0, 0.0) is None
    assert rate_upper_bound(0, 0.0) is None


# percentiles over groups


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=12),
    st.lists(st.integers(0, 3), min_size=12, max_size=12),
    st.floats(0.0, 100.0),
)
@settings(deadline=None)
def test_a_resample_has_the_percentile_of_its_values_written_out(
    numbers: list[float], often: list[int], percent: float
) -> None:
    values = np.sort(np.array(numbers))
    times = np.array(often[: len(values)])
    times[0] += 1
    found = intervals._weighted_percentiles(values, times[None, :], percent)
    assert found[0] == pytest.approx(np.percentile(np.repeat(values, times), percent), abs=1e-9)


def test_resampling_two_groups_gives_one_of_them_half_of_the_time() -> None:
    interval = percentile_interval([np.zeros(5), np.ones(5)], 50.0)
    assert interval is not None
    assert (interval.low, interval.high, interval.method) == (0.0, 1.0, "bootstrap")


def test_the_interval_of_a_percentile_agrees_with_resampling_written_out() -> None:
    rng = np.random.default_rng(3)
    groups = [rng.normal(rng.normal(), 1.0, rng.integers(5, 30)) for _ in range(20)]
    found = percentile_interval(groups, 5.0)
    own = [
        np.percentile(np.concatenate([groups[i] for i in rng.integers(0, 20, 20)]), 5.0) for _ in range(4000)
    ]
    assert found is not None
    # Two sets of resamples: the ends of their intervals differ by their own sampling error.
    error = 4.0 * np.std(own) / np.sqrt(999 * 0.05)
    assert (found.low, found.high) == pytest.approx(np.percentile(own, [2.5, 97.5]), abs=error)


def test_a_percentile_interval_is_the_same_every_time_and_needs_two_groups() -> None:
    groups = [np.array([1.0, 2.0, 5.0]), np.array([0.5, 3.0]), np.array([2.5])]
    assert percentile_interval(groups, 95.0) == percentile_interval(groups, 95.0)
    assert percentile_interval([*groups, np.array([])], 95.0) == percentile_interval(groups, 95.0)
    assert percentile_interval(groups[:1], 95.0) is None
    assert percentile_interval([np.ones(3), np.ones(4)], 95.0) is None


# ratios


def test_contributions_have_the_ratio_as_mean_and_the_error_of_a_weighted_regression() -> None:
    # It takes long to load, and every worker collects this file.
    from statsmodels.regression.linear_model import WLS

    rng = np.random.default_rng(5)
    trials = rng.integers(1, 40, 25).astype(float)
    events = rng.binomial(trials.astype(int), 0.3).astype(float)
    each = contributions(events, trials)
    # The same estimator as statsmodels has it: a weighted mean of the runs' shares with robust errors.
    fit = WLS(events / trials, np.ones(25), weights=trials).fit(cov_type="HC1", use_t=True)
    assert each.mean() == pytest.approx(events.sum() / trials.sum())
    assert each.mean() == pytest.approx(fit.params[0])
    assert stats.sem(each) == pytest.approx(fit.bse[0])
    interval = mean_interval(each)
    assert interval is not None
    assert (interval.low, interval.high) == pytest.approx(fit.conf_int()[0].tolist())


def test_over_equal_denominators_contributions_are_the_runs_own_ratios() -> None:
    assert contributions(np.array([1.0, 2.0, 6.0]), np.full(3, 4.0)) == pytest.approx([0.25, 0.5, 1.5])
    assert contributions(np.array([1.0, 2.0]), np.ones(2)) == pytest.approx([1.0, 2.0])
    with pytest.raises(ValueError, match="positive denominator"):
        contributions(np.zeros(2), np.zeros(2))


# replications


@pytest.mark.parametrize(
    ("variation", "needed"),
    [
        (0.1, {0.05: 18, 0.10: 7, 0.15: 5, 0.20: 4}),
        (0.2, {0.05: 64, 0.10: 18, 0.15: 10, 0.20: 7}),
        (0.3, {0.05: 141, 0.10: 38, 0.15: 18, 0.20: 12}),
        (0.5, {0.05: 387, 0.10: 99, 0.15: 46, 0.20: 27}),
        (1.0, {0.05: 1540, 0.10: 387, 0.15: 174, 0.20: 99}),
    ],
)
def test_the_number_of_runs_is_that_of_the_published_table(
    variation: float, needed: dict[float, int]
) -> None:
    assert {e: replications_needed(-4.0, 4.0 * variation, e) for e in needed} == needed


@given(st.floats(0.01, 3.0))
@settings(deadline=None)
def test_the_number_of_runs_is_the_smallest_that_is_enough(variation: float) -> None:
    n = replications_needed(1.0, variation)
    assert n is not None

    def half_width(count: int) -> float:
        return float(stats.t.ppf(0.975, count - 1) * variation / np.sqrt(count))

    assert half_width(n) <= 0.1 * (1.0 + 1e-12)
    assert n == 2 or half_width(n - 1) > 0.1 * (1.0 - 1e-12)


def test_no_number_of_runs_brings_precision_relative_to_a_mean_of_zero() -> None:
    assert replications_needed(0.0, 1.0) is None
    assert replications_needed(5.0, 0.0) == 2
    assert replications_needed(1e-9, 1.0) is None


# paired values


def test_three_pairs_by_hand() -> None:
    # Differences 1, 1, 2: t = (4/3) / (0.57735 / sqrt(3)) = 4; with 2 degrees p = 1 − t / sqrt(t² + 2).
    found = compare_values(np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 5.0]))
    assert (found.pairs, found.test, found.status) == (3, "paired_t", "ok")
    assert found.statistic == pytest.approx(4.0)
    assert found.p_value == pytest.approx(1.0 - 4.0 / np.sqrt(18.0))
    assert found.effect_size == pytest.approx(4.0 / np.sqrt(3.0))
    assert found.correlation == pytest.approx(np.corrcoef([1, 2, 3], [2, 3, 5])[0, 1])


def test_five_pairs_are_tested_by_t_however_skewed_and_the_sleep_data_by_ranks() -> None:
    few = compare_values(np.zeros(5), np.array([0.0, 0.0, 0.0, 0.1, 9.0]))
    assert few.test == "paired_t"
    sleep = compare_values(SLEEP_1, SLEEP_2)  # one patient slept 4.6 h longer: skewness above 1
    assert (sleep.test, sleep.effect_size) == ("wilcoxon", 1.0)
    assert sleep.difference == pytest.approx(1.58)


def test_nine_pairs_with_the_ranks_of_a_textbook_have_its_p() -> None:
    # Depression scores before and after, in Hollander and Wolfe: ranks 2 and 3 positive, W = 5,
    # p = 2 · 10 / 2^9. The magnitudes are powers here, so that the differences are skewed.
    signs = np.array([-1, 1, 1, -1, -1, -1, -1, -1, -1])
    differences = signs * 3.0 ** np.arange(9)
    found = compare_values(np.zeros(9), differences)
    assert (found.test, found.statistic) == ("wilcoxon", 5.0)
    assert found.p_value == pytest.approx(20.0 / 512.0)
    assert found.effect_size == pytest.approx((5.0 - 40.0) / 45.0)


def test_five_of_thirty_pairs_that_differ_have_the_p_of_five_signs() -> None:
    # 2 / 2^5, however many seeds show no difference: SciPy's normal distribution would say 0.025 and 0.043.
    base = np.linspace(1.0, 30.0, 30)
    for more in (np.ones(5), np.arange(1.0, 6.0)):
        found = compare_values(base, base + np.append(more, np.zeros(25)))
        assert (found.test, found.statistic, found.effect_size) == ("wilcoxon", 0.0, 1.0)
        assert found.p_value == pytest.approx(2.0 / 2.0**5)


def test_what_rounding_leaves_of_equal_pairs_is_no_difference() -> None:
    # Contributions of delays are the delays up to rounding, of each side another one.
    delays = np.random.default_rng(8).gamma(2.0, 3.0, 30)
    worse = delays + np.append(np.arange(5.0, 10.0), np.zeros(25))
    base, alt = (contributions(values, np.ones(30)) for values in (delays, worse))
    assert np.count_nonzero(alt - base) > 5
    assert compare_values(base, alt).p_value == pytest.approx(2.0 / 2.0**5)


def test_the_order_of_the_two_sides_only_turns_the_sign() -> None:
    rng = np.random.default_rng(7)
    base, alt = rng.normal(size=12), rng.normal(1.0, 2.0, 12)
    one, other = compare_values(base, alt), compare_values(alt, base)
    assert one.p_value == pytest.approx(other.p_value)
    assert one.effect_size == pytest.approx(-(other.effect_size or 0.0))
    assert one.interval is not None
    assert other.interval is not None
    assert one.interval.low == pytest.approx(-other.interval.high)


def test_pairs_that_go_together_narrow_the_interval() -> None:
    rng = np.random.default_rng(8)
    common = rng.normal(0.0, 10.0, 20)
    base, alt = common + rng.normal(size=20), common + 1.0 + rng.normal(size=20)
    paired, shuffled = compare_values(base, alt), compare_values(base, rng.permutation(alt))
    assert paired.correlation is not None
    assert paired.correlation > 0.95
    assert paired.interval is not None
    assert shuffled.interval is not None
    width = [interval.high - interval.low for interval in (paired.interval, shuffled.interval)]
    assert width[0] < 0.3 * width[1]


@pytest.mark.parametrize(
    ("base", "alt", "status", "test"),
    [
        ([], [], "no_pairs", "none"),
        ([1.0], [3.0], "one_pair", "none"),
        ([1.0, 2.0], [1.0, 2.0], "no_difference", "none"),
        ([0.3, 0.1 + 0.2], [0.1 + 0.2, 0.3], "no_difference", "none"),
        ([1.0, 2.0, 3.0], [1.5, 2.5, 3.5], "constant_difference", "sign"),
    ],
)
def test_what_cannot_be_tested_says_why(base: list[float], alt: list[float], status: str, test: str) -> None:
    found = compare_values(np.array(base), np.array(alt))
    assert (found.status, found.test) == (status, test)
    assert found.interval is None
    assert (found.p_value is None) == (test == "none")


def test_the_same_difference_in_all_of_n_pairs_has_p_of_two_halves_to_the_n() -> None:
    found = compare_values(np.arange(7.0), np.arange(7.0) - 0.25)
    assert found.p_value == pytest.approx(2.0 / 2.0**7)
    assert found.effect_size == -1.0


# yes or no


def test_mcnemar_counts_only_the_pairs_that_differ() -> None:
    found = compare_yes_no(*pairs_of(both=5, only_base=10, only_alt=2, neither=30))
    assert found.test == "mcnemar"
    assert found.p_value == pytest.approx(2.0 * (1 + 12 + 66) / 4096.0)
    assert found.effect_size == pytest.approx(-8.0 / 12.0)
    assert found.difference == pytest.approx(-8.0 / 47.0)


def test_the_interval_of_paired_shares_is_the_textbooks() -> None:
    # Approval of a prime minister in two surveys, Agresti: 794 both, 150 first only, 86 second only.
    found = compare_yes_no(*pairs_of(both=794, only_base=150, only_alt=86, neither=570))
    assert found.interval is not None
    assert (found.interval.low, found.interval.high) == pytest.approx((-0.0587, -0.0212), abs=1e-4)
    assert found.interval.method == "agresti_min"


def test_no_collision_on_either_side_still_leaves_room_for_a_difference() -> None:
    found = compare_yes_no(*pairs_of(both=0, only_base=0, only_alt=0, neither=30))
    assert (found.status, found.p_value) == ("no_difference", None)
    assert found.interval is not None
    assert found.interval.high == pytest.approx(1.959964 / 32.0, rel=1e-6)
    assert found.interval.low == -found.interval.high


def test_one_pair_of_yes_and_no_is_tested_and_shows_nothing() -> None:
    found = compare_yes_no(np.array([0.0]), np.array([1.0]))
    assert found.p_value == pytest.approx(1.0)
    assert compare_yes_no(np.array([]), np.array([])).status == "no_pairs"


# Holm


def test_holm_corrects_as_in_the_manual_of_r() -> None:
    assert holm([0.01, 0.02, 0.03, 0.04]) == pytest.approx([0.04, 0.06, 0.06, 0.06])
    assert holm([0.04, 0.001, 0.6]) == pytest.approx([0.08, 0.003, 0.6])


def test_holm_corrects_as_statsmodels_does() -> None:
    from statsmodels.stats.multitest import multipletests

    @settings(max_examples=20)
    @given(st.lists(st.floats(0.0, 1.0) | st.sampled_from([0.01, 0.04]), min_size=1, max_size=12))
    def the_same(p_values: list[float]) -> None:
        assert holm(p_values) == multipletests(p_values, method="holm")[1].tolist()

    the_same()


def test_a_test_that_was_not_made_is_not_in_the_family() -> None:
    assert holm([None, 0.02, None]) == [None, 0.02, None]
    assert holm([None]) == [None]
    assert holm([]) == []
