"""Real beside simulated: differences, intervals, and verdicts in words."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.validation.comparison import compare, in_words
from studies.validation import planted


def test_the_interval_is_that_of_a_difference_of_means() -> None:
    rng = np.random.default_rng(3)
    real, simulated = rng.normal(1.0, 0.5, 200), rng.normal(1.3, 0.5, 300)
    found = compare(real, simulated)
    error = np.sqrt(real.var(ddof=1) / 200 + simulated.var(ddof=1) / 300)
    assert found.difference == pytest.approx(simulated.mean() - real.mean())
    assert found.low == pytest.approx(found.difference - 1.96 * error, abs=0.15 * error)
    assert found.high == pytest.approx(found.difference + 1.96 * error, abs=0.15 * error)
    assert found.detectable == pytest.approx(2.80 * error, rel=0.06)


def test_the_verdict_says_by_how_much_or_what_would_have_been_shown() -> None:
    base = np.linspace(0.0, 1.0, 30)
    other = compare(base, base + 2.0)
    assert in_words(other, "m/s").startswith("different: simulated higher by 2.00 m/s (1.8")
    assert other.distance == 1.0
    same = compare(base, base)
    assert same.verdict == "indistinguishable"
    assert f"a difference of {same.detectable:.2f} m would have been shown" in in_words(same, "m")
    few = compare(base[:3], base)
    assert in_words(few, "s") == "cannot be said: 3 real and 30 simulated road users"


def test_one_road_user_in_many_runs_is_too_few() -> None:
    assert compare(np.arange(10.0), np.arange(6.0), ["one"] * 6).verdict == "too few"


def test_undefined_values_of_road_users_are_left_out() -> None:
    values = np.array([1.0, np.nan, 2.0, 3.0, 4.0, np.inf, 5.0])
    found = compare(values, values)
    assert (found.n_real, found.real) == (5, 3.0)


def test_the_same_tracks_give_the_same_interval() -> None:
    values = np.random.default_rng(1).normal(size=(2, 50))
    assert compare(*values) == compare(*values)


@pytest.mark.slow
def test_a_planted_difference_of_a_fifth_of_a_standard_deviation_is_found_with_the_stated_power() -> None:
    # 80 % of 200: 160, with a standard deviation of 5.7.
    assert 140 <= planted.power(200) <= 180


def test_the_same_drivers_in_more_runs_are_no_more_drivers() -> None:
    rng = np.random.default_rng(7)
    real, once = rng.normal(0.0, 1.0, 40), rng.normal(0.3, 1.0, 40)
    names = [f"car{number}" for number in range(40)]
    one = compare(real, once, names)
    three = compare(real, np.tile(once, 3), names * 3)
    assert three.n_simulated == 120
    assert three.difference == pytest.approx(one.difference)
    assert (three.low, three.high, three.detectable) == pytest.approx((one.low, one.high, one.detectable))
    independent = compare(real, np.tile(once, 3))
    assert independent.high - independent.low < 0.9 * (three.high - three.low)
