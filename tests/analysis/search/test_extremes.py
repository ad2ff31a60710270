"""The cross-check by extreme values, on tails that are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import genpareto

from analysis.arrays import FloatArray
from analysis.search.extremes import FEWEST_PEAKS, extrapolated
from analysis.search.objective import squashed

SHAPE, SCALE = 0.1, 0.5


def margins(probability: float, count: int, seed: int) -> FloatArray:
    """Return margins of which the nearest tenth has a tail of `SHAPE` and `SCALE`, and 0 is so probable."""
    generator = np.random.default_rng(seed)
    threshold = genpareto.isf(10.0 * probability, SHAPE, scale=SCALE)
    near = generator.random(count) < 0.1
    beyond = genpareto.rvs(SHAPE, scale=SCALE, size=count, random_state=generator)
    distances = np.where(near, threshold - beyond, threshold + generator.random(count))
    return np.array([squashed(one) for one in distances])


@pytest.mark.long
@pytest.mark.parametrize("probability", [0.01, pytest.param(0.001, marks=pytest.mark.slow)])
def test_most_intervals_hold_the_probability_of_a_tail_that_is_of_this_kind(probability: float) -> None:
    found = [extrapolated(margins(probability, 2000, seed), seed) for seed in range(20)]
    held = [one is not None and one.low <= probability <= one.high for one in found]
    assert sum(held) >= 16
    assert np.mean([one.probability for one in found if one]) == pytest.approx(probability, rel=0.3)


def test_the_tail_is_the_one_that_scipy_fits() -> None:
    drawn = margins(1e-6, 5000, 1)
    found = extrapolated(drawn, 1)
    assert found is not None
    assert found.margins == 5000
    assert found.peaks == 500
    distances = np.sort(drawn / (1.0 - drawn))
    threshold = distances[500]
    shape, _, scale = genpareto.fit(threshold - distances[:500], floc=0.0)
    assert found.shape == pytest.approx(shape, abs=0.02)
    beyond = genpareto.sf(threshold, found.shape, scale=scale)
    assert found.probability == pytest.approx(0.1 * beyond, rel=0.3)


def test_how_hard_contacts_are_changes_nothing() -> None:
    drawn = margins(0.01, 2000, 3)
    assert np.count_nonzero(drawn < 0.0) > 5
    other = np.where(drawn < 0.0, -1.0, drawn)
    assert extrapolated(drawn, 3) == extrapolated(other, 3)


def test_the_same_seed_gives_the_same_interval() -> None:
    drawn = margins(0.001, 1000, 2)
    assert extrapolated(drawn, 1) == extrapolated(drawn, 1)
    assert extrapolated(drawn, 1) != extrapolated(drawn, 2)


def test_it_says_nothing_of_few_near_misses_many_events_or_nobody_met() -> None:
    assert extrapolated([], 1) is None
    assert extrapolated(margins(0.001, 10 * (FEWEST_PEAKS - 10), 1), 1) is None
    assert extrapolated([-0.5] * 150 + [0.5] * 850, 1) is None
    assert extrapolated([0.5] * 50 + [1.0] * 950, 1) is None
