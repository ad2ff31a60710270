"""The walking model and the predictor made of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from controllers.arrays import FloatArray
from controllers.prediction import by_name
from controllers.prediction.social_force_model import CarOutline, SocialForceModel, Walkers, aims_of
from tests.controllers.scenes import Walker, ego, perception, straight_road

MODEL = SocialForceModel()


def _crowd(count: int, speed: float = 1.25) -> Walkers:
    none = np.zeros(count)
    return Walkers(none, none, none, np.full(count, speed))


def _walked(crowd: Walkers, duration: float, step: float, seed: int, speed: float = 1.25) -> Walkers:
    drawn = np.random.default_rng(seed)
    aims = replace(aims_of(crowd.x_speed, crowd.y_speed), speed=np.full(len(crowd.x), speed))
    for _ in range(round(duration / step)):
        crowd = MODEL.walk(crowd, aims, None, step, drawn.standard_normal(len(crowd.x)))
    return crowd


def test_a_free_crowd_keeps_the_published_speed_and_spread_whatever_the_step() -> None:
    for step in (0.05, 0.1, 0.5):
        walked = _walked(_crowd(4000), 10.0, step, seed=2)
        assert walked.y_speed.mean() == pytest.approx(1.25, abs=0.005)
        assert walked.y_speed.std() == pytest.approx(0.05, abs=0.005)
        assert walked.y.mean() == pytest.approx(12.5, abs=0.02)
        assert not walked.x.any()


def test_who_is_slower_comes_up_to_their_mean_speed_with_the_relaxation_time() -> None:
    walked = _walked(_crowd(4000, 0.8), 0.5, 0.05, seed=1)
    assert walked.y_speed.mean() == pytest.approx(1.25 - 0.45 * math.exp(-1.0), abs=0.005)


def test_the_push_is_that_of_the_formula_within_what_a_person_can_do() -> None:
    for distance in (1.95, 2.2, 3.0, 6.0):
        x, y = MODEL.push(np.array([0.6 * distance]), np.array([0.8 * distance]), CarOutline(0.0, 0.0, 0.0))
        size = 4.5 * math.exp(5.5 * (1.95 - distance))
        assert (x[0], y[0]) == pytest.approx((0.6 * size, 0.8 * size))
    x, y = MODEL.push(np.array([0.1, 0.0]), np.zeros(2), CarOutline(0.0, 0.0, 0.0))
    assert x.tolist() == pytest.approx([MODEL.hardest, 0.0])


def test_a_push_makes_nobody_faster_than_people_run_and_slows_down_nobody_who_is() -> None:
    place, none = np.full(3, 1.0), np.zeros(3)
    walkers = Walkers(place, none, np.array([-2.4, 2.4, 3.0]), none)
    aims = aims_of(walkers.x_speed, walkers.y_speed)
    pushed = MODEL.walk(walkers, aims, CarOutline(0.0, 0.0, 0.0), 0.5, none)
    slowed = -2.4 + 0.5 * MODEL.hardest
    assert pushed.x_speed.tolist() == pytest.approx([slowed, MODEL.fastest, 3.0])


@given(some.floats(-6.0, 6.0), some.floats(-6.0, 6.0), some.floats(-3.0, 3.0))
def test_the_push_leads_away_from_the_car_and_turns_with_it(x: float, y: float, heading: float) -> None:
    car = CarOutline(1.0, 2.0, heading, half_axis=1.4)
    push = np.array(MODEL.push(np.array([x]), np.array([y]), car))[:, 0]
    cosine, sine = math.cos(heading), math.sin(heading)
    along = (x - 1.0) * cosine + (y - 2.0) * sine
    beside = (y - 2.0) * cosine - (x - 1.0) * sine
    straight = np.array(
        MODEL.push(np.array([along]), np.array([beside]), CarOutline(0.0, 0.0, 0.0, half_axis=1.4))
    )[:, 0]
    np.testing.assert_allclose(push @ [cosine, sine], straight[0], atol=1e-9)
    np.testing.assert_allclose(push @ [-sine, cosine], straight[1], atol=1e-9)
    assert push @ (np.array([x, y]) - [1.0, 2.0]) >= -1e-12


def test_somebody_who_walks_towards_a_near_car_is_turned_back() -> None:
    walkers = Walkers(np.zeros(1), np.array([-1.9]), np.zeros(1), np.array([1.25]))
    aims = aims_of(walkers.x_speed, walkers.y_speed)
    lowest = 1.25
    for _ in range(20):
        walkers = MODEL.walk(walkers, aims, CarOutline(0.0, 0.0, 0.0), 0.05, np.zeros(1))
        lowest = min(lowest, float(walkers.y_speed[0]))
    assert lowest < 0.0
    assert walkers.y[0] < -1.25


def test_who_stands_has_no_aim() -> None:
    aims = aims_of(np.array([0.05, 3.0]), np.array([0.0, 4.0]))
    assert aims.speed.tolist() == [0.0, 5.0]
    assert aims.x.tolist() == [0.0, 0.6]
    assert aims.y.tolist() == [0.0, 0.8]


TIMES: FloatArray = np.linspace(0.0, 4.0, 41)


def test_a_forecast_far_from_the_car_is_a_straight_walk_that_spreads() -> None:
    scene = perception(ego(0.0), straight_road(), [Walker(40.0, -3.0, 0.0, 1.3)])
    forecast = by_name.build("social_force", seed=5).predict(scene, TIMES)
    np.testing.assert_allclose(forecast.across[0], -3.0 + 1.3 * TIMES, atol=0.1)
    np.testing.assert_allclose(forecast.along[0], 40.0, atol=1e-9)
    assert forecast.reach[0, 0] == 0.0
    assert (np.diff(forecast.reach[0]) > -0.01).all()
    # Two standard deviations of an integrated chain: σ √(2 τ t − 2 τ² (1 − e^(−t/τ))).
    spread = 0.05 * math.sqrt(2.0 * 0.5 * 4.0 - 2.0 * 0.25 * (1.0 - math.exp(-8.0)))
    assert forecast.reach[0, -1] == pytest.approx(2.0 * spread, rel=0.35)


def test_a_forecast_stops_before_a_car_that_comes() -> None:
    walker = Walker(12.0, -2.6, 0.0, 1.2)
    away, near = (
        by_name.build("social_force", seed=5).predict(
            perception(ego(speed), straight_road(), [walker]), TIMES
        )
        for speed in (0.0, 8.0)
    )
    assert (near.across[0] <= away.across[0] + 1e-9).all()
    assert near.across[0, 20] < near.across[0, 12] < away.across[0, 20] - 1.0


def test_the_seed_decides_the_forecast() -> None:
    scene = perception(ego(5.0), straight_road(), [Walker(20.0, -3.0, 0.0, 1.2)])
    first, again, other = (
        by_name.build("social_force", seed=seed).predict(scene, TIMES) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.across, again.across)
    assert np.abs(first.across - other.across).max() > 1e-4
