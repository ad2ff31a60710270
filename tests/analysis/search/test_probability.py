"""Estimates of probabilities that are known."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import norm, t

from analysis.arrays import FloatArray
from analysis.search.probability import METHODS, estimate, in_words
from analysis.search.subset import subset_simulation

DIMENSION = 6


def plane(probability: float) -> Callable[[FloatArray], FloatArray]:
    """Return a margin that is negative with this probability."""
    distance = -norm.ppf(probability)
    return lambda inputs: np.asarray(distance - inputs.sum(axis=1) / math.sqrt(DIMENSION))


@pytest.mark.long
@pytest.mark.parametrize(("method", "probability"), [("crude", 0.02), ("subset", 1e-4), ("importance", 1e-5)])
def test_most_intervals_hold_a_known_probability(method: str, probability: float) -> None:
    found = [
        estimate(method, plane(probability), DIMENSION, variation=0.3, most=30000, seed=1000 * seed)
        for seed in range(10)
    ]
    # Of ten 95 % intervals, fewer than eight hold it once in eighty times.
    assert sum(one.low <= probability <= one.high for one in found) >= 8
    assert np.mean([one.estimate for one in found]) == pytest.approx(probability, rel=0.25)
    for one in found:
        assert one.reached
        assert one.variation is not None
        assert one.variation <= 0.3


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_estimate(method: str) -> None:
    first, second, other = (
        estimate(method, plane(0.01), DIMENSION, variation=0.3, most=3000, seed=seed) for seed in (1, 1, 2)
    )
    assert first == second
    assert first.estimate != other.estimate


@pytest.mark.parametrize("method", METHODS)
def test_what_was_drawn_from_the_distribution_is_kept_apart_from_what_a_method_led_to_the_event(
    method: str,
) -> None:
    found = estimate(method, plane(1e-3), DIMENSION, variation=0.3, most=3000, seed=5)
    # The margin is the distance of the plane minus a standard normal number.
    level = {"crude": found.runs, "importance": 400, "subset": 400}[method]
    assert len(found.drawn) == level * found.replications
    off = np.array(found.drawn) + norm.ppf(1e-3)
    assert abs(np.mean(off)) < 4.0 / math.sqrt(off.size)
    assert np.std(off) == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * off.size))


def test_importance_sampling_needs_less_than_a_hundredth_of_the_runs_of_crude_sampling() -> None:
    found = estimate("importance", plane(1e-5), DIMENSION, variation=0.3, most=30000, seed=7)
    # Crude sampling needs 1 / (p · 0.3²) runs for a coefficient of variation of 0.3.
    assert found.runs < 0.01 / (1e-5 * 0.3**2)


@pytest.mark.long
@pytest.mark.parametrize("method", ["subset", pytest.param("importance", marks=pytest.mark.slow)])
def test_intervals_hold_what_has_two_regions(method: str) -> None:
    distance = -norm.ppf(0.5e-5)

    def far_on_either_side(inputs: FloatArray) -> FloatArray:
        return np.asarray(distance - np.abs(inputs[:, 0]))

    found = [
        estimate(method, far_on_either_side, DIMENSION, variation=0.3, most=30000, seed=10**6 + 1000 * seed)
        for seed in range(20)
    ]
    # Of twenty 95 % intervals, fewer than sixteen hold it once in four hundred times.
    assert sum(one.low <= 1e-5 <= one.high for one in found) >= 16
    assert np.mean([one.runs for one in found]) < 0.01 / (1e-5 * 0.3**2)


def test_an_interval_of_repeated_estimates_is_that_of_a_lognormal_mean() -> None:
    found = estimate("subset", plane(1e-3), DIMENSION, variation=0.3, most=30000, seed=3)
    ones = [
        subset_simulation(plane(1e-3), DIMENSION, level=400, share=0.1, seed=3 + number)
        for number in range(found.replications)
    ]
    assert found.estimate == pytest.approx(np.mean(ones))
    # Cox: the variance of the mean of the logarithms, and that of half their variance.
    variance = np.var(np.log(ones), ddof=1)
    deviation = math.sqrt(variance / len(ones) + variance**2 / (2.0 * (len(ones) - 1)))
    wide = t.ppf(0.975, len(ones) - 1) * deviation
    assert math.log(found.high / found.estimate) == pytest.approx(wide)
    assert math.log(found.estimate / found.low) == pytest.approx(wide)


@pytest.mark.parametrize("method", ["subset", "importance"])
def test_replications_that_a_margin_leads_nowhere_are_given_up_and_counted(method: str) -> None:
    def jumps(inputs: FloatArray) -> FloatArray:
        """Just miss the more the larger the first number is, and touch where that does not matter."""
        margin = 0.05 + np.abs(inputs[:, 0] - 3.0)
        return np.asarray(np.where(inputs[:, 1] < -4.5, -1.0, margin))

    found = estimate(method, jumps, DIMENSION, variation=0.2, most=10000, seed=1)
    assert found.dropped
    assert not found.reached
    assert found.runs < 20000


def test_crude_sampling_stops_at_its_budget_and_says_so() -> None:
    found = estimate("crude", plane(1e-6), DIMENSION, variation=0.3, most=250, seed=1)
    assert (found.runs, found.events, found.estimate, found.reached) == (250, 0, 0.0, False)
    # Exact: (0.025)^(1/250) is the largest share of non-events that is excluded.
    assert found.high == pytest.approx(1.0 - 0.025 ** (1.0 / 250.0))
    assert found.variation is None


def test_an_error_of_the_runs_is_told_and_not_one_of_the_library() -> None:
    def broken(inputs: FloatArray) -> FloatArray:
        raise OSError("no room for files")

    for method in METHODS:
        with pytest.raises(OSError, match="no room for files"):
            estimate(method, broken, DIMENSION, variation=0.3, most=1000, seed=1)


def test_an_interval_is_told_in_numbers_of_passages() -> None:
    assert in_words(2.2e-6, 8.7e-6) == "between 2 and 9 in a million"
    assert in_words(0.0, 0.0141) == "at most 15 in a thousand"
    assert in_words(0.2, 0.3) == "between 20 and 30 in a hundred"
