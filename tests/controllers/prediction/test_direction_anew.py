"""Directions chosen anew: who keeps, who straightens, who keeps clear of the car."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.interface import Perception
from controllers.prediction.direction_anew import DirectionAnew, Reaction
from controllers.prediction.direction_choice import DirectionModel
from controllers.prediction.forecast import Forecast
from tests.controllers.scenes import Walker, ego, perception, straight_road

TIMES = np.linspace(0.0, 4.0, 41)


def _predict(scene: Perception, reaction: Reaction | None = None) -> Forecast:
    return DirectionAnew(DirectionModel(), reaction).predict(scene, TIMES)


def _walker(degrees: float, speed: float = 1.4, along: float = 60.0, across: float = 1.0) -> Walker:
    """Return somebody on the road who walks to the left at an angle to the cars' direction."""
    angle = math.radians(degrees)
    return Walker(along, across, speed * math.cos(angle), speed * math.sin(angle))


def _angle(forecast: Forecast) -> float:
    by_along = forecast.along[0, 5] - forecast.along[0, 0]
    by_across = forecast.across[0, 5] - forecast.across[0, 0]
    return math.degrees(math.atan2(by_across, by_along))


def test_who_walks_straight_across_far_from_the_car_goes_on() -> None:
    scene = perception(ego(speed=0.0), straight_road(3), [_walker(90.0)])
    forecast = _predict(scene)
    assert _angle(forecast) == pytest.approx(90.0, abs=0.5)
    assert 0.0 < forecast.reach[0, 10] < 0.3 * 1.4


def test_who_walks_obliquely_straightens_a_little() -> None:
    scene = perception(ego(speed=0.0), straight_road(3), [_walker(50.0)])
    assert 51.0 < _angle(_predict(scene)) < 65.0


def test_who_would_meet_the_car_turns_away_from_it_and_who_would_not_does_not() -> None:
    """Straight across they would be 1.65 m from its middle in 0.96 s; it has passed them after 1.00 s."""
    road = straight_road(3, 1)
    meets = perception(ego(speed=10.0), road, [_walker(90.0, along=8.8, across=-3.0)])
    assert _angle(_predict(meets, Reaction(refusal=0.0))) == pytest.approx(90.0, abs=0.5)
    assert 91.0 < _angle(_predict(meets)) < 105.0, "a little against the cars, and so behind this one"
    passed = perception(ego(speed=10.0), road, [_walker(90.0, along=8.8, across=-4.0)])
    assert _angle(_predict(passed)) == pytest.approx(90.0, abs=0.5)


def test_they_stop_counting_when_they_are_over() -> None:
    scene = perception(ego(speed=0.0), straight_road(3), [_walker(90.0, speed=2.0)])
    forecast = _predict(scene)
    assert forecast.across[0, -1] == pytest.approx(scene.road.left_edge)
    assert forecast.across[0, -1] == forecast.across[0, -2]
