"""What of a perception becomes which obstacle."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Body, Perception
from controllers.potential_field.field import distance_to_shift, needed_shift, side_distance
from controllers.potential_field.road_field import (
    FORECAST_TIMES,
    FieldSettings,
    Meetings,
    field_of,
    meetings,
    obstacles_on,
)
from controllers.prediction import by_name
from tests.controllers.scenes import LANE_WIDTH, Car, Walker, ego, perception, straight_road

BODY = Body()
MIDDLE = BODY.front - 0.5 * BODY.length
SETTINGS = FieldSettings()
HERE = np.zeros(1)


def _met(seen: Perception, predictor: str = "constant_velocity") -> Meetings:
    return meetings(seen, by_name.build(predictor).predict(seen, FORECAST_TIMES))


@pytest.mark.parametrize(
    "walker",
    [
        Walker(50.0, 3.0, 0.0, -1.25),
        Walker(33.0, -2.0, 1.1, 0.6),
        Walker(20.0, 1.0, -1.4, 0.1),
        Walker(-8.0, 1.0, 0.3, 1.0),
        Walker(MIDDLE, 1.0, 0.0, 1.0),
    ],
)
def test_the_conflict_point_is_where_the_middles_are_level(walker: Walker) -> None:
    speed = 15.0
    seen = perception(ego(speed), walkers=[walker])
    met = _met(seen)
    time = (walker.along - MIDDLE) / (speed - walker.along_speed)
    assert met.along[0] == pytest.approx(walker.along + walker.along_speed * time, abs=1e-9)
    assert met.across[0] == pytest.approx(walker.across + walker.across_speed * time, abs=1e-9)
    assert met.along[0] == pytest.approx(MIDDLE + speed * time, abs=1e-9)
    assert met.matters[0]


@pytest.mark.parametrize(
    "walker",
    [
        Walker(500.0, 0.0),
        Walker(-80.0, 0.0),
        Walker(-5.0, 0.0, 16.0),
        Walker(5.0, 0.0, 16.0),
    ],
)
def test_who_is_met_much_later_or_was_long_ago_or_never_does_not_matter(walker: Walker) -> None:
    met = _met(perception(ego(15.0), walkers=[walker]))
    assert not met.matters[0]
    assert np.isfinite(met.along).all()
    assert np.isfinite(met.across).all()


def test_the_half_axes_are_the_papers() -> None:
    seen = perception(ego(20.0), walkers=[Walker(40.0, 0.7)])
    found = obstacles_on(seen, _met(seen), HERE, SETTINGS)
    safe = side_distance(0.25, BODY.width, 0.6)
    axis = distance_to_shift(20.0, needed_shift(np.array([0.7]), 0.0, safe), SETTINGS.lateral_acceleration)
    assert found.long_axis[0, 0] == pytest.approx(axis[0])
    assert found.side_axis[0, 0] == pytest.approx(safe)
    assert found.along[0, 0] == pytest.approx(40.0 - MIDDLE)
    assert found.share[0, 0] == 1.0
    fixed = obstacles_on(seen, _met(seen), HERE, FieldSettings(fixed_axis=15.0))
    assert fixed.long_axis[0, 0] == 15.0


def test_the_shift_is_that_from_the_lane_and_not_from_the_ego() -> None:
    """An ego that is past already would need no shift; the field must not collapse while it is used."""
    walker = Walker(40.0, 0.7)
    here, aside = (perception(ego(20.0, across=across), walkers=[walker]) for across in (0.0, -1.3))
    axes = [obstacles_on(seen, _met(seen), HERE, SETTINGS).long_axis[0, 0] for seen in (here, aside)]
    assert axes[0] == axes[1]


def test_who_needs_no_shift_in_a_lane_is_no_obstacle_there() -> None:
    seen = perception(ego(15.0), straight_road(2, 0), walkers=[Walker(40.0, LANE_WIDTH)])
    found = obstacles_on(seen, _met(seen), np.array([0.0, LANE_WIDTH]), SETTINGS)
    assert found.share[:, 0].tolist() == [0.0, 1.0]


def test_vehicles_beside_the_lane_are_obstacles_that_move_and_those_in_it_are_not() -> None:
    cars = [Car(30.0, 0.0, 10.0), Car(8.0, LANE_WIDTH, 12.0), Car(300.0, LANE_WIDTH, 12.0)]
    seen = perception(ego(15.0), straight_road(2, 0), cars=cars)
    found = obstacles_on(seen, _met(seen), HERE, SETTINGS)
    assert found.share[0].tolist() == [0.0, 1.0, 0.0]
    assert found.along_speed[0].tolist() == [10.0, 12.0, 12.0]
    assert found.along[0, 1] == pytest.approx(8.0 - 2.25 - MIDDLE)
    shape = field_of(seen, HERE, found, SETTINGS)
    _, push = shape.gradient(np.array([found.along[0, 1]]), np.array([2.0]))
    assert push[0] > 0.05, "pushes to the right, away from the car in the left lane"
    _, push = shape.gradient(np.array([found.along[0, 1]]), np.array([0.0]))
    assert abs(push[0]) < 0.01, "hardly felt in the middle of the own lane"


def test_the_lines_are_those_between_lanes() -> None:
    for lanes, expected in ((1, []), (2, [1.75]), (3, [1.75, 5.25])):
        road = straight_road(lanes, 0)
        seen = perception(road=road)
        found = field_of(seen, HERE, obstacles_on(seen, _met(seen), HERE, SETTINGS), SETTINGS)
        # The third lane is not in view from the first one, the line before it is.
        np.testing.assert_allclose(found.lines, expected)
        assert (found.right_edge, found.left_edge) == (road.right_edge, road.left_edge)


def test_at_a_standstill_obstacles_are_those_of_a_slow_ego() -> None:
    seen = perception(ego(0.0), walkers=[Walker(6.0, 0.2)])
    found = obstacles_on(seen, _met(seen), HERE, SETTINGS)
    assert found.share[0, 0] == 1.0
    assert 1.0 < found.long_axis[0, 0] < 3.0
