"""Subset simulation of probabilities that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import norm

from analysis.arrays import FloatArray
from analysis.search.subset import subset_simulation


def mean_of_many(shape: str, probability: float, count: int) -> tuple[float, float]:
    """Return the mean of many estimates and its standard deviation, as shares of the probability."""
    distance, each = (-norm.ppf(one) for one in (probability, 0.5 * probability))

    def margin(inputs: FloatArray) -> FloatArray:
        if shape == "one region":
            return np.asarray(distance - inputs.sum(axis=1) / math.sqrt(inputs.shape[1]))
        return np.asarray(each - np.abs(inputs[:, 0]))

    ones = [subset_simulation(margin, 6, level=400, share=0.1, seed=seed) for seed in range(count)]
    return float(np.mean(ones)) / probability, float(np.std(ones)) / probability / math.sqrt(count)


@pytest.mark.parametrize("shape", ["one region", "two regions"])
def test_the_mean_of_many_estimates_is_the_probability(shape: str) -> None:
    mean, deviation = mean_of_many(shape, 1e-4, 400)
    assert deviation < 0.03
    assert mean == pytest.approx(1.0, abs=3.5 * deviation)


def test_a_probability_above_the_share_of_a_level_is_that_of_crude_sampling() -> None:
    def margin(inputs: FloatArray) -> FloatArray:
        return np.asarray(inputs[:, 0])

    inputs = np.random.default_rng(7).standard_normal((400, 2))
    assert subset_simulation(margin, 2, level=400, share=0.1, seed=7) == np.mean(inputs[:, 0] < 0.0)


def test_margins_that_are_nearly_all_equal_lead_on_from_the_few_that_differ() -> None:
    def margin(inputs: FloatArray) -> FloatArray:
        """Nothing comes near unless the first number is below −2."""
        return np.where(inputs[:, 0] < -2.0, 0.2 * (inputs[:, 0] + 3.5), 1.0)

    # Each estimate has fewer seeds than chains at first: 400 · Φ(−2) = 9.
    ones = [subset_simulation(margin, 3, level=400, share=0.1, seed=seed) for seed in range(300)]
    deviation = float(np.std(ones)) / math.sqrt(len(ones))
    assert np.mean(ones) == pytest.approx(norm.cdf(-3.5), abs=3.5 * deviation)
    assert deviation < 0.1 * norm.cdf(-3.5)


def test_margins_without_a_slope_end_in_no_estimate() -> None:
    assert subset_simulation(lambda inputs: np.ones(len(inputs)), 3, level=400, share=0.1, seed=1) == 0.0
