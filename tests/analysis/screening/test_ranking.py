"""Ranks of crossings and their intervals, on counts whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.screening.ranking import Ranking, rank
from analysis.screening.shrinkage import MOST_DISPERSION, expected, fit

CROSSINGS, RUNS, WALKS = 20, 10, 40
RATE = 0.05


def simulated(seed: int, factor: float) -> Ranking:
    """Return the ranking of equal crossings, of which number 7 has a rate that many times as high."""
    rng = np.random.default_rng(seed)
    rates = np.full((CROSSINGS, 1), RATE)
    rates[7] *= factor
    walks = rng.poisson(WALKS, (CROSSINGS, RUNS)).astype(np.float64)
    return rank(rng.poisson(rates * walks).astype(np.float64), walks, 30.0)


def test_a_planted_crossing_ranks_first_with_an_interval_that_says_so() -> None:
    found = [simulated(seed, 3.0) for seed in range(50)]
    assert sum(one.rank[7] == 1.0 for one in found) >= 45
    assert sum(one.p_worse[7] < 0.05 for one in found) >= 40
    assert np.mean([one.rank_high[7] - one.rank_low[7] for one in found]) < 3.0


def test_among_equal_crossings_few_are_called_worse_and_ranks_are_uncertain() -> None:
    found = [simulated(seed, 1.0) for seed in range(50)]
    assert np.mean([(one.p_worse < 0.05).mean() for one in found]) <= 0.05
    assert np.mean([one.rank_high - one.rank_low for one in found]) > 8.0


def test_a_crossing_with_few_pedestrians_is_not_ranked() -> None:
    found = rank(np.array([[3.0, 0.0], [1.0, 1.0]]), np.array([[4.0, 2.0], [40.0, 40.0]]), 30.0)
    assert np.isnan([found.rank[0], found.rate[0], found.p_worse[0]]).all()
    assert found.rank[1] == 1.0


def test_a_single_run_gives_ranks_without_intervals() -> None:
    found = rank(np.array([[3.0], [1.0]]), np.array([[40.0], [40.0]]), 30.0)
    assert found.rank.tolist() == [1.0, 2.0]
    assert np.isnan([*found.rank_low, *found.rank_high, *found.p_worse]).all()


@pytest.mark.parametrize("walks", [0.0, 40.0])
def test_nothing_is_divided_by_nothing(walks: float) -> None:
    found = rank(np.zeros((3, 4)), np.full((3, 4), walks), 0.0)
    assert np.isnan(found.rank).all() if walks == 0.0 else (found.rank == 2.0).all()
    assert np.isnan(found.p_worse).all()


def test_the_prior_finds_back_how_places_differ() -> None:
    rng = np.random.default_rng(3)
    rates = rng.gamma(2.0, 0.05, 4000)  # mean 0.1, squared coefficient of variation 0.5
    exposure = rng.uniform(50.0, 150.0, 4000)
    prior = fit(rng.poisson(rates * exposure).astype(np.float64), exposure)
    assert prior.mean == pytest.approx(0.1, rel=0.03)
    assert prior.dispersion == pytest.approx(0.5, rel=0.08)


def test_few_walks_are_drawn_to_the_mean_and_many_are_believed() -> None:
    prior = fit(np.array([5.0, 10.0, 40.0]), np.array([100.0, 100.0, 100.0]))
    assert 0.0 < prior.dispersion < MOST_DISPERSION
    few, many = expected(np.array([2.0, 2000.0]), np.array([2.0, 2000.0]), prior)
    assert prior.mean < few < 0.8
    assert many == pytest.approx(1.0, abs=0.01)


def test_ten_thousand_crossings_are_ranked_and_few_of_them_called_worse_for_nothing() -> None:
    rng = np.random.default_rng(1)
    walks = rng.poisson(40, (10_000, 5)).astype(np.float64)
    ranking = rank(rng.poisson(0.2 * walks).astype(np.float64), walks, 30.0)
    assert np.isfinite(ranking.rank).all()
    assert (ranking.rank_low <= ranking.rank_high).all()
    assert (ranking.p_worse < 0.05).mean() <= 0.05
