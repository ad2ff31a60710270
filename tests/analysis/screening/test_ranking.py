"""Ranks of crossings and their intervals, on counts whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.screening.consequences import Risks, belief_in
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK, Counted, Ranking, rank
from analysis.screening.shrinkage import MOST_DISPERSION, expected, fit

CROSSINGS, RUNS, WALKS = 20, 10, 40
RATE = 0.05


def ranked(conflicts: np.ndarray, walks: np.ndarray, least: float, by: str = BY_CONFLICTS) -> Ranking:
    """Return the ranking of crossings at which no speed is known."""
    return rank(Counted(conflicts, walks, Risks(*(np.zeros(walks.shape) for _ in range(3)))), least, by)


def simulated(seed: int, factor: float) -> Ranking:
    """Return the ranking of equal crossings, of which number 7 has a rate that many times as high."""
    rng = np.random.default_rng(seed)
    rates = np.full((CROSSINGS, 1), RATE)
    rates[7] *= factor
    walks = rng.poisson(WALKS, (CROSSINGS, RUNS)).astype(np.float64)
    return ranked(rng.poisson(rates * walks).astype(np.float64), walks, 30.0)


@pytest.mark.long
def test_a_planted_crossing_ranks_first_with_an_interval_that_says_so() -> None:
    found = [simulated(seed, 3.0) for seed in range(50)]
    assert sum(one.rank[7] == 1.0 for one in found) >= 45
    assert sum(one.p_worse[7] < 0.05 for one in found) >= 40
    assert np.mean([one.rank_high[7] - one.rank_low[7] for one in found]) < 3.0


@pytest.mark.long
def test_among_equal_crossings_few_are_called_worse_and_ranks_are_uncertain() -> None:
    found = [simulated(seed, 1.0) for seed in range(50)]
    assert np.mean([(one.p_worse < 0.05).mean() for one in found]) <= 0.05
    assert np.mean([one.rank_high - one.rank_low for one in found]) > 8.0


def test_a_crossing_with_few_pedestrians_is_not_ranked() -> None:
    found = ranked(np.array([[3.0, 0.0], [1.0, 1.0]]), np.array([[4.0, 2.0], [40.0, 40.0]]), 30.0)
    assert np.isnan([found.rank[0], found.rate[0], found.p_worse[0]]).all()
    assert found.rank[1] == 1.0


def test_a_single_run_gives_ranks_without_intervals() -> None:
    found = ranked(np.array([[3.0], [1.0]]), np.array([[40.0], [40.0]]), 30.0)
    assert found.rank.tolist() == [1.0, 2.0]
    assert np.isnan([*found.rank_low, *found.rank_high, *found.p_worse]).all()


@pytest.mark.parametrize("walks", [0.0, 40.0])
def test_nothing_is_divided_by_nothing(walks: float) -> None:
    found = ranked(np.zeros((3, 4)), np.full((3, 4), walks), 0.0)
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


@pytest.mark.long
@pytest.mark.parametrize("count", [2_000, pytest.param(10_000, marks=pytest.mark.slow)])
def test_thousands_of_crossings_are_ranked_and_few_of_them_called_worse_for_nothing(count: int) -> None:
    """Two thousand are more than one block of percentiles and more than one of resamples."""
    rng = np.random.default_rng(1)
    walks = rng.poisson(40, (count, 5)).astype(np.float64)
    ranking = ranked(rng.poisson(0.2 * walks).astype(np.float64), walks, 30.0)
    assert np.isfinite(ranking.rank).all()
    assert (ranking.rank_low <= ranking.rank_high).all()
    assert (ranking.p_worse < 0.05).mean() <= 0.05


def with_speeds(seed: int, factor: float, by: str) -> Ranking:
    """Return the ranking of crossings with equal rates; at number 7 so many times as many would die."""
    rng = np.random.default_rng(seed)
    walks = rng.poisson(WALKS, (CROSSINGS, RUNS)).astype(np.float64)
    conflicts = rng.poisson(4.0 * RATE * walks).astype(np.float64)
    met = rng.poisson(walks).astype(np.float64)
    means = np.full((CROSSINGS, 1), 0.02)
    means[7] *= factor
    # Exponential values, summed: gamma distributions; their squares have twice the squared mean.
    total = means * rng.gamma(np.maximum(met, 1e-9))
    return rank(Counted(conflicts, walks, Risks(total, 2.0 * means**2 * met, met)), 30.0, by)


@pytest.mark.long
def test_a_crossing_with_faster_vehicles_ranks_first_by_risk_and_not_by_conflicts() -> None:
    found = [with_speeds(seed, 4.0, BY_RISK) for seed in range(50)]
    assert sum(one.rank[7] == 1.0 for one in found) >= 45
    assert sum(one.p_worse[7] < 0.05 for one in found) >= 40
    assert np.mean([one.p_fatal[7] for one in found]) == pytest.approx(0.08, rel=0.1)
    assert sum(one.ranks[BY_CONFLICTS][7] == 1.0 for one in found) <= 8
    other = with_speeds(1, 4.0, BY_CONFLICTS)
    assert (other.rank == other.ranks[BY_CONFLICTS]).all()


@pytest.mark.long
def test_among_equal_speeds_few_crossings_are_called_worse_and_none_is_believed_to_be_deadlier() -> None:
    found = [with_speeds(seed, 1.0, BY_RISK) for seed in range(50)]
    assert np.mean([(one.p_worse < 0.05).mean() for one in found]) <= 0.05
    # A twentieth is the chance spread of a mean of 400 such values.
    assert max(np.ptp(one.p_fatal) for one in found) < 0.2 * 0.02


def test_where_no_speed_is_known_risk_ranks_as_conflicts_do_and_is_not_said() -> None:
    conflicts, walks = np.array([[3.0, 1.0], [1.0, 0.0]]), np.full((2, 2), 40.0)
    by_risk, by_conflicts = (ranked(conflicts, walks, 30.0, by) for by in (BY_RISK, BY_CONFLICTS))
    assert by_risk.rank.tolist() == by_conflicts.rank.tolist() == [1.0, 2.0]
    assert by_risk.p_worse.tolist() == by_conflicts.p_worse.tolist()
    assert np.isnan(by_risk.p_fatal).all()


def test_the_mean_of_few_encounters_is_drawn_to_the_usual_one() -> None:
    rng = np.random.default_rng(5)
    truth = rng.gamma(4.0, 0.01, 2000)  # mean 0.04, variance 0.0004
    met = rng.integers(1, 60, 2000).astype(np.float64)
    values = [mean * rng.exponential(size=int(count)) for mean, count in zip(truth, met, strict=True)]
    total, squares = (np.array([[(one**power).sum()] for one in values]) for power in (1, 2))
    belief = belief_in(Risks(total, squares, met[:, None]))
    # Variance within of an exponential value: the mean of the squared means, 0.04² + 0.0004.
    assert belief.usual == pytest.approx(0.04, rel=0.03)
    assert belief.half == pytest.approx(0.002 / 0.0004, rel=0.2)
    drawn, raw = belief.of(total[:, 0], met), total[:, 0] / met
    # The mean of 1 / (n + 5) over that of 1 / n, n from 1 to 59.
    better = np.square(drawn - truth).mean() / np.square(raw - truth).mean()
    assert better == pytest.approx(0.53, rel=0.15)
    assert belief.of(np.zeros(1), np.zeros(1))[0] == pytest.approx(belief.usual)


def test_a_network_with_a_single_crossing_has_nothing_to_be_drawn_to() -> None:
    found = rank(
        Counted(np.array([[2.0, 1.0]]), np.full((1, 2), 40.0), Risks(*(np.ones((1, 2)) for _ in range(3)))),
        30.0,
    )
    assert found.rank.tolist() == [1.0]
    assert found.p_fatal.tolist() == [1.0]
    assert np.isnan(found.p_worse).all()
