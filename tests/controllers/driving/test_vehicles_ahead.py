"""Vehicles ahead as bounds on the position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from controllers.driving.vehicles_ahead import ROOM_TO_TURN, Blockade, blockade
from controllers.geometry.footprints import footprints
from tests.controllers.scenes import FRONT, Car, bend, perception, straight_road, vehicles

BAND = (-1.2, 1.2)
TIMES = np.array([0.5, 1.0, 2.0, 4.0])


def _ahead(cars: Sequence[Car]) -> Blockade:
    return blockade(perception(road=straight_road(3, 1), cars=cars), BAND, TIMES)


def test_a_turned_body_has_the_box_that_holds_it() -> None:
    box = footprints(vehicles([Car(20.0, 1.0, heading_error=np.pi / 2), Car(20.0, 0.0, heading_error=np.pi)]))
    # The front bumper is at 20 m; a body across the road reaches half its width each way.
    assert (box.rear[0], box.front[0]) == pytest.approx((20.0 - 0.9, 20.0 + 0.9))
    assert (box.right[0], box.left[0]) == pytest.approx((1.0 - 2.25, 1.0 + 2.25))
    assert (box.rear[1], box.front[1]) == pytest.approx((20.0, 24.5))
    assert box.same_way.tolist() == [False, False]


def test_an_empty_road_bounds_nothing() -> None:
    for cars in ([], [Car(40.0, 3.5, 10.0)], [Car(-8.0, 0.0, 15.0)]):
        free = _ahead(cars)
        assert np.isinf(free.rear).all()
        assert np.isinf(free.rest).all()
        assert free.name == ""


def test_a_vehicle_that_keeps_its_speed_moves_its_rear_bumper_with_it() -> None:
    found = _ahead([Car(40.0, 0.0, 8.0)])
    assert found.rear == pytest.approx(35.5 + 8.0 * TIMES)
    assert found.rest == pytest.approx(35.5 + 8.0 * TIMES + 8.0**2 / 16.0)
    assert found.name == "car0"


def test_a_vehicle_that_brakes_goes_on_for_two_seconds_and_then_keeps_its_speed() -> None:
    found = _ahead([Car(40.0, 0.0, 10.0, acceleration=-3.0)])
    braked = 10.0 * TIMES - 1.5 * TIMES**2
    braked[3] = 10.0 * 2.0 - 1.5 * 4.0 + 4.0 * 2.0
    assert found.rear == pytest.approx(35.5 + braked)
    assert found.rest[3] == pytest.approx(found.rear[3] + 4.0**2 / 16.0)


def test_a_vehicle_that_brakes_to_a_standstill_does_not_roll_back() -> None:
    found = _ahead([Car(40.0, 0.0, 2.0, acceleration=-5.0)])
    assert found.rear == pytest.approx(35.5 + np.full(4, 2.0**2 / 10.0))
    assert found.rest == pytest.approx(found.rear)


def test_a_vehicle_that_speeds_up_is_believed_for_one_second() -> None:
    found = _ahead([Car(40.0, 0.0, 5.0, acceleration=1.0)])
    gained = np.array([0.125, 0.5, 1.5, 3.5])
    assert found.rear == pytest.approx(35.5 + 5.0 * TIMES + gained)


def test_the_nearest_at_each_time_counts() -> None:
    found = _ahead([Car(40.0, 0.0, 10.0), Car(50.0, 0.0, 1.0)])
    assert found.rear == pytest.approx(np.minimum(35.5 + 10.0 * TIMES, 45.5 + TIMES))
    assert found.name == "car0"


def test_a_vehicle_that_drifts_into_the_band_counts_before_it_is_there() -> None:
    beside = Car(40.0, 3.5, 8.0)
    assert _ahead([beside]).name == ""
    assert _ahead([Car(40.0, 3.5, 8.0, across_speed=-0.8)]).name == "car0"
    assert _ahead([Car(40.0, 3.5, 8.0, across_speed=0.8)]).name == ""
    assert _ahead([Car(40.0, 3.5, 8.0, across_speed=-0.1)]).name == ""


def test_a_vehicle_beside_the_ego_that_drifts_towards_it_is_not_ahead() -> None:
    overlapping = Car(FRONT + 2.0, 3.0, 8.0, across_speed=-1.0)
    assert _ahead([overlapping]).name == ""
    # But one that overlaps along the road and is well inside the band is.
    assert _ahead([Car(FRONT + 2.0, 1.0, 8.0)]).name == "car0"


def test_an_oncoming_or_crossing_vehicle_stands_where_it_is() -> None:
    oncoming = _ahead([Car(40.0, 0.5, -10.0, heading_error=np.pi)])
    assert oncoming.rear == pytest.approx(np.full(4, 40.0))
    assert _ahead([Car(40.0, 4.5, 0.0, across_speed=-6.0, heading_error=-np.pi / 2)]).name == ""


@pytest.mark.parametrize("heading", [np.pi, 0.6 * np.pi, -0.5 * np.pi])
def test_a_vehicle_that_gets_out_of_the_lane_is_left_room_to_turn(heading: float) -> None:
    stands, drives, same_way = (
        _ahead([car])
        for car in (
            Car(20.0, 0.5, 0.5, heading_error=heading),
            Car(20.0, 0.5, -5.0, heading_error=heading),
            Car(20.0, 0.5, 0.0),
        )
    )
    assert stands.follow == pytest.approx(stands.rear - ROOM_TO_TURN)
    assert drives.follow == pytest.approx(drives.rear), "it will not be there any more"
    assert same_way.follow == pytest.approx(same_way.rear)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_front_swings_out_in_a_tight_bend_towards_a_vehicle_that_stands_beside_it(side: float) -> None:
    straight = straight_road(3, 1)
    left_hand = bend(straight, 2.0, 5.0, 8.0)
    tight = replace(left_hand, curvature=-side * left_hand.curvature)
    # At a radius of 5 m and half a width more, the corner of a front 3.6 m long is 1.0 m farther out.
    stands = Car(9.0, side * 2.9, heading_error=np.pi)
    drives = replace(stands, along_speed=-5.0)
    inside = replace(stands, across=-side * 2.9)
    beyond = replace(stands, along=20.0)
    names = [
        blockade(perception(road=road, cars=[car]), BAND, TIMES).name
        for road, car in (
            (tight, stands),
            (straight, stands),
            (tight, drives),
            (tight, inside),
            (tight, beyond),
        )
    ]
    assert names == ["car0", "", "", "", ""]
    found = blockade(perception(road=tight, cars=[stands]), BAND, TIMES)
    assert found.follow == pytest.approx(found.rear), "it is beside the lane and needs no room to leave it"


@pytest.mark.parametrize(("along", "blocks"), [(12.0, True), (14.0, False)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_behind_a_tight_bend_the_front_has_swung_back_before_vehicles_at_their_line(
    side: float, along: float, blocks: bool
) -> None:
    left_hand = bend(straight_road(3, 1), 2.0, 5.0, 8.0)
    road = replace(left_hand, curvature=-side * left_hand.curvature)
    oncoming = Car(along, side * 2.3, heading_error=np.pi)
    assert (blockade(perception(road=road, cars=[oncoming]), BAND, TIMES).name == "car0") == blocks
