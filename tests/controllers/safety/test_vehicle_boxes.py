"""The rectangles of vehicles near the ego, and that a plan into one that stands brakes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.geometry.box_clearances import Boxes
from controllers.safety.last_check import SHIELDED, LastCheck
from controllers.safety.vehicle_boxes import (
    DRIVEN_FOR,
    crossing_vehicles,
    driving_vehicles,
    oncoming_vehicles,
    standing_vehicles,
)
from tests.controllers.scenes import FRONT, Car, bend, ego, keeps, perception, straight_road

NOBODY = np.zeros(0, dtype=np.bool_)


def _extents(boxes: Boxes) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the least and the largest x and y of any corner [m]."""
    along, aside = boxes.length * np.cos(boxes.heading), boxes.width * np.sin(boxes.heading)
    up, out = boxes.length * np.sin(boxes.heading), boxes.width * np.cos(boxes.heading)
    wide, high = 0.5 * (np.abs(along) + np.abs(aside)), 0.5 * (np.abs(up) + np.abs(out))
    x, y = boxes.x, boxes.y
    return ((x - wide).min(), (x + wide).max()), ((y - high).min(), (y + high).max())


def test_a_vehicle_reaches_from_its_front_backwards() -> None:
    along, across = _extents(standing_vehicles(perception(cars=[Car(10.0, 2.0, length=4.0, width=2.0)])))
    assert along == pytest.approx((6.0, 10.0))
    assert across == pytest.approx((1.0, 3.0))


def test_one_that_stands_across_the_road_is_turned_about_its_middle() -> None:
    across = Car(10.0, 0.0, length=4.0, width=2.0, heading_error=np.pi / 2.0)
    x, y = _extents(standing_vehicles(perception(cars=[across])))
    assert x == pytest.approx((9.0, 11.0))
    assert y == pytest.approx((-2.0, 2.0))


def test_those_who_drive_or_are_far_do_not_count() -> None:
    seen = perception(cars=[Car(10.0, 0.0, along_speed=1.0), Car(60.0, 0.0)])
    assert len(standing_vehicles(seen).x) == 0


@pytest.mark.parametrize(("across", "status"), [(0.5, SHIELDED), (1.7, SHIELDED), (2.2, "ok")])
def test_a_plan_into_a_vehicle_that_stands_brakes(across: float, status: str) -> None:
    seen = perception(ego(speed=5.0), straight_road(2), cars=[Car(FRONT + 2.0 + 4.5, across)])
    assert LastCheck().checked(seen, keeps(5.0), NOBODY).status == status


@pytest.mark.parametrize("length", [4.5, 12.0, 18.75])
def test_of_a_long_vehicle_the_tail_counts_however_far_its_front_is(length: float) -> None:
    seen = perception(ego(speed=5.0), straight_road(2), cars=[Car(FRONT + 2.0 + length, 0.5, length=length)])
    assert len(standing_vehicles(seen).x) == 1
    assert LastCheck().checked(seen, keeps(5.0), NOBODY).status == SHIELDED


def test_in_a_bend_the_box_is_that_of_the_place_in_the_world() -> None:
    """Along the road, the front of a vehicle beside a bend of 6 m is told of another place than its middle."""
    seen = perception(
        ego(speed=3.0),
        bend(straight_road(), 0.0, 6.0, 12.0),
        cars=[Car(9.0, 3.0, length=5.0, heading_error=0.4)],
    )
    placed = replace(seen.vehicles, position=np.array([[6.0, 7.0]]), heading=np.array([np.pi / 2.0]))
    x, y = _extents(standing_vehicles(replace(seen, vehicles=placed)))
    assert x == pytest.approx((5.1, 6.9))
    assert y == pytest.approx((2.0, 7.0))


def test_those_who_drive_are_wherever_they_will_be_but_for_the_ones_behind() -> None:
    crosses = Car(10.0, -6.0, across_speed=2.0, heading_error=np.pi / 2.0)
    follows = Car(-3.0, 0.0, along_speed=4.0)
    x, y = _extents(driving_vehicles(perception(ego(speed=0.0), cars=[crosses, follows])))
    assert x == pytest.approx((9.1, 10.9))
    assert y == pytest.approx((-6.0 - 2.25, -6.0 + 2.25 + 2.0 * DRIVEN_FOR[-1]))


def test_an_ego_that_starts_lets_a_vehicle_pass_that_drives_across_its_way() -> None:
    """It drives at 3 m/s through the place that the ego gets to in the next seconds."""
    turned = Car(FRONT + 1.0, -3.0, across_speed=3.0, heading_error=np.pi / 2.0)
    beyond = Car(FRONT + 1.0, 9.0, across_speed=3.0, heading_error=np.pi / 2.0)
    leader = Car(FRONT + 3.0 + 4.5, 0.0, along_speed=3.0)
    for car, status in ((turned, SHIELDED), (beyond, "ok"), (leader, "ok")):
        seen = perception(ego(speed=0.0), straight_road(2), cars=[car])
        assert LastCheck().checked(seen, keeps(1.0), NOBODY).status == status


def test_vehicles_that_drive_across_are_where_they_will_be() -> None:
    crosses = Car(10.0, -6.0, across_speed=2.0, heading_error=np.pi / 2.0)
    found = crossing_vehicles(perception(ego(speed=0.0), cars=[crosses]), np.array([0.0, 1.5]))
    assert found.x[:, 0] == pytest.approx([10.0, 10.0])
    assert found.y[1, 0] - found.y[0, 0] == pytest.approx(3.0)


@pytest.mark.parametrize(("comes", "status"), [(-4.0, SHIELDED), (4.0, "ok"), (None, "ok")])
def test_a_front_that_swings_out_in_a_turn_waits_for_a_vehicle_that_comes_beside(
    comes: float | None, status: str
) -> None:
    """A right turn of 6 m: the front's left corner is 2 m beside the lane's middle, they begin at 1.7 m."""
    turn = bend(straight_road(), 0.0, -6.0, 9.0)
    car = Car(9.0, 2.6, along_speed=comes or 0.0, heading_error=np.pi if comes != 4.0 else 0.0)
    seen = perception(ego(speed=4.0), turn, cars=[car] if comes else [])
    assert LastCheck().checked(seen, keeps(4.0), NOBODY).status == status


@pytest.mark.parametrize(
    ("along", "across", "speed", "status"),
    [
        (1.0, -1.4, 4.0, SHIELDED),
        (-3.0, -1.4, 7.0, SHIELDED),
        (1.0, 1.4, 4.0, "ok"),
        (-6.0, -1.4, 2.0, "ok"),
        (1.0, -3.0, 4.0, "ok"),
    ],
)
@pytest.mark.parametrize("stood", [False, True])
def test_an_ego_that_turns_lets_a_cyclist_beside_it_in_its_lane_ride_on(
    along: float, across: float, speed: float, status: str, stood: bool
) -> None:
    """Not one on the other side, one too slow to be met, nor one in a lane of their own, who is a foe."""
    turn = bend(straight_road(), 4.0, -8.0, 4.0 * np.pi)
    bicycle = Car(along, across, along_speed=speed, length=1.6, width=0.65)
    check = LastCheck()
    if stood:
        check.checked(perception(ego(speed=0.0), turn), keeps(4.0), NOBODY)
    seen = perception(ego(speed=0.45 if stood else 4.0), turn, cars=[bicycle])
    assert check.checked(seen, keeps(4.0), NOBODY).status == status


@pytest.mark.parametrize(
    ("along", "speed", "status"), [(0.0, 4.0, SHIELDED), (-6.0, 6.0, SHIELDED), (-9.0, 1.0, "ok")]
)
def test_an_ego_that_starts_beside_the_middle_of_its_lane_lets_others_in_it_pass(
    along: float, speed: float, status: str
) -> None:
    """After a way out, say; not one that comes too late."""
    aside = ego(speed=0.0, across=-1.4, heading_error=0.3)
    seen = perception(aside, straight_road(), cars=[Car(along, 0.9, along_speed=speed)])
    assert LastCheck().checked(seen, keeps(2.0), NOBODY).status == status


@pytest.mark.parametrize(
    ("across", "speed", "status"),
    [(3.2, 13.0, SHIELDED), (3.2, 3.0, "ok"), (5.2, 13.0, "ok"), (-3.2, 13.0, "ok")],
)
def test_an_ego_that_swings_out_of_a_bend_lets_a_vehicle_pass_on_the_outer_side(
    across: float, speed: float, status: str
) -> None:
    """Not one that comes too late, drives farther out, or drives on the inner side."""
    road = bend(straight_road(), 0.0, -6.0, 2.0)  # the end of a turn, for which the ego has swung wide
    passes = Car(-4.0, across, along_speed=speed, heading_error=-0.33)
    seen = perception(ego(speed=1.2, across=0.6, heading_error=0.2), road, cars=[passes])
    assert LastCheck().checked(seen, keeps(1.2), NOBODY).status == status


def test_on_a_straight_road_nothing_is_worked_out_for_vehicles_that_come_beside() -> None:
    seen = perception(ego(speed=4.0), cars=[Car(14.0, 1.5, along_speed=-4.0, heading_error=np.pi)])
    assert LastCheck().checked(seen, keeps(4.0), NOBODY).status == "ok"


def test_vehicles_that_come_towards_the_ego_follow_the_road() -> None:
    turn = bend(straight_road(), 0.0, 10.0, 5.0 * np.pi)
    comes = Car(5.0 * np.pi, -3.0, along_speed=-2.0, heading_error=np.pi, length=4.0)
    found = oncoming_vehicles(perception(ego(speed=3.0), turn, cars=[comes]), np.array([0.0, 1.0]))
    angles = (5.0 * np.pi + 2.0 - 2.0 * np.array([0.0, 1.0])) / 10.0
    at = angles <= 0.5 * np.pi  # on the bend; the first one's middle is still on the straight road beyond
    x, y = 13.0 * np.sin(angles), 10.0 - 13.0 * np.cos(angles)
    assert found.x[at, 0] == pytest.approx(x[at], abs=0.3)
    assert found.y[at, 0] == pytest.approx(y[at], abs=0.3)
    assert at.any()
