"""The reachable set holds whatever a pedestrian may do, and not much more."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.prediction import reachable_set
from controllers.prediction.forecast import Forecast
from tests.controllers.scenes import Walker, perception

TIMES = np.linspace(0.0, 5.0, 51)
ACCELERATION, PACE = 1.5, 2.5


def _forecast(*walkers: Walker) -> Forecast:
    return reachable_set.build().predict(perception(walkers=walkers), TIMES)


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(pace=st.floats(0.0, 3.5), course=st.floats(0.0, 6.3), seed=st.integers(0, 10_000))
def test_nobody_leaves_it_whatever_they_do(pace: float, course: float, seed: int) -> None:
    """Random accelerations, switched at random, cut where the pace would exceed its bound."""
    drawn = np.random.default_rng(seed)
    velocity = pace * np.array([np.cos(course), np.sin(course)])
    forecast = _forecast(Walker(20.0, -3.0, float(velocity[0]), float(velocity[1])))
    place, step, bound = np.array([20.0, -3.0]), 0.01, max(PACE, pace)
    push = np.zeros(2)
    for index in range(1, 501):
        if drawn.random() < 0.02 or index == 1:
            angle = drawn.uniform(0.0, 2.0 * np.pi)
            push = ACCELERATION * np.array([np.cos(angle), np.sin(angle)])
        after = velocity + push * step
        after *= min(1.0, bound / max(float(np.hypot(*after)), 1e-12))
        place = place + 0.5 * (velocity + after) * step
        velocity = after
        if index % 10 == 0:
            k = index // 10
            off = np.hypot(place[0] - forecast.along[0, k], place[1] - forecast.across[0, k])
            assert off <= forecast.reach[0, k] + 1e-3


def test_who_stands_may_be_anywhere_around_them() -> None:
    """A t²/2 until V/A = 1.67 s, then V more each second."""
    forecast = _forecast(Walker(20.0, -3.0))
    np.testing.assert_allclose(forecast.along, 20.0)
    np.testing.assert_allclose(forecast.reach[0, 10], 0.75)
    np.testing.assert_allclose(forecast.reach[0, 30], 2.5 * 3.0 - 2.5**2 / 3.0)


def test_it_is_as_tight_as_who_stands_can_show() -> None:
    """Constant acceleration in one direction reaches the border."""
    forecast = _forecast(Walker(0.0, 0.0))
    speed = np.minimum(ACCELERATION * TIMES, PACE)
    way = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 0.1)))
    np.testing.assert_allclose(forecast.reach[0], way, atol=0.02)


def test_it_never_shrinks_and_stays_below_what_either_bound_allows() -> None:
    forecast = _forecast(Walker(0.0, 0.0, 1.4, 0.0), Walker(0.0, 0.0, 0.0, -3.0))
    assert (np.diff(forecast.reach, axis=1) >= -1e-9).all()
    assert (forecast.reach <= 0.5 * ACCELERATION * TIMES**2 + 1e-9).all()
    assert (np.abs(np.diff(forecast.along[0])) <= 0.3).all(), "the middle does not jump"


@pytest.mark.parametrize("given_values", [{"acceleration": 0.0}, {"pace": float("inf")}])
def test_bounds_that_bound_nothing_are_refused(given_values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be above 0 and finite"):
        reachable_set.build(**given_values)
