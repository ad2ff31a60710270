"""The model of directions as a predictor."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from controllers.interface import CrossingKind
from controllers.prediction import by_name
from controllers.prediction.direction_choice import ANGLES, DirectionModel, Errand
from tests.controllers.scenes import LANE_WIDTH, Walker, perception, straight_road, zebra

TIMES = np.linspace(0.0, 12.0, 25)
ROAD = straight_road(2, 0)
RIGHT, LEFT = ROAD.right_edge, ROAD.left_edge


def test_it_is_one_of_the_predictors() -> None:
    assert "direction_model" in by_name.names()


def test_who_walks_keeps_their_direction_without_doubt() -> None:
    seen = perception(road=ROAD, walkers=[Walker(30.0, LEFT, 0.4, -1.1)])
    forecast = by_name.build("direction_model").predict(seen, TIMES)
    np.testing.assert_allclose(forecast.along[0], 30.0 + 0.4 * TIMES)
    np.testing.assert_allclose(forecast.across[0], LEFT - 1.1 * TIMES)
    assert not forecast.reach.any()


@pytest.mark.parametrize(("kerb", "sign"), [(RIGHT - 0.3, 1.0), (LEFT + 0.3, -1.0)])
def test_who_stands_at_a_kerb_steps_out_and_stops_at_the_other_one(kerb: float, sign: float) -> None:
    seen = perception(road=ROAD, walkers=[Walker(30.0, kerb)])
    forecast = by_name.build("direction_model").predict(seen, TIMES)
    until = (2.0 * LANE_WIDTH + 0.3) / 1.25
    walked = 1.25 * np.minimum(TIMES, until)
    np.testing.assert_allclose(forecast.across[0], kerb + sign * walked)
    np.testing.assert_allclose(forecast.along[0], 30.0, atol=1e-9)
    spread = DirectionModel().spread(Errand(2.0 * LANE_WIDTH))
    np.testing.assert_allclose(forecast.reach[0], spread * walked)
    assert 0.1 < spread < 0.5


def test_the_reach_is_the_root_mean_square_of_where_they_may_be() -> None:
    model, errand = DirectionModel(), Errand(7.0)
    drawn = np.random.default_rng(3)
    best = model.most_probable(errand)
    angles = drawn.choice(ANGLES, 20000, p=model.probabilities(errand))
    apart = np.hypot(np.cos(angles) - math.cos(best), np.sin(angles) - math.sin(best))
    assert model.spread(errand) == pytest.approx(float(np.sqrt(np.mean(apart**2))), rel=0.02)


@pytest.mark.parametrize("across", [0.0, RIGHT + 1.0, LEFT - 1.0, RIGHT - 3.0])
def test_who_stands_elsewhere_stays(across: float) -> None:
    seen = perception(road=ROAD, walkers=[Walker(30.0, across)])
    forecast = by_name.build("direction_model").predict(seen, TIMES)
    np.testing.assert_allclose(forecast.across[0], across)
    assert not forecast.reach.any()


def test_who_waits_for_a_crossing_walks_between_its_kerbs() -> None:
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=-6.0, left=9.0)
    waiting = Walker(30.0, -8.0, crossing=0, waiting=True)
    seen = perception(road=ROAD, walkers=[waiting], crossings=[crossing])
    forecast = by_name.build("direction_model").predict(seen, TIMES)
    assert forecast.across[0, -1] == pytest.approx(-8.0 + 1.25 * 12.0)
    gone = replace(seen, pedestrians=replace(seen.pedestrians, waiting=np.array([False])))
    stays = by_name.build("direction_model").predict(gone, TIMES)
    assert stays.across[0, -1] == pytest.approx(-8.0)
