"""Keeping away from people beside the lane, as far as the lane has room."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from controllers.driving.lanes import place_in_lane
from controllers.interface import Body, RoadAhead
from tests.controllers.scenes import LANE_WIDTH, Car, Walker, bend, ego, perception, straight_road

BODY = Body()
ROOM = 0.5 * LANE_WIDTH - 0.5 * BODY.width - place_in_lane.TO_THE_LINE


STRAIGHT = straight_road(3, 1)
TURN = bend(STRAIGHT, 10.0, -6.0, 3.0 * np.pi)
"""A turn to the right."""


def _offset(
    walkers: Sequence[Walker],
    cars: Sequence[Car] = (),
    stays: bool = True,
    across: float = 0.0,
    road: RoadAhead = STRAIGHT,
) -> float:
    seen = perception(ego(across=across), road, walkers, cars)
    found = place_in_lane.look(seen, np.full(len(walkers), stays))
    lane = found.road.lane(1)
    assert lane is not None
    others = [(one.number, one.offset) for one in found.road.lanes if one.number != 1]
    assert others == [(0, -LANE_WIDTH), (2, LANE_WIDTH)], "only the own lane's line moves"
    return lane.offset


def _beside(gap: float, side: float, along: float = 20.0) -> Walker:
    return Walker(along, side * (0.5 * BODY.width + 0.25 + gap))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_moves_as_far_as_is_wanted_and_no_farther(side: float) -> None:
    assert _offset([_beside(0.5, side)]) == pytest.approx(-0.3 * side)
    assert _offset([_beside(0.9, side)]) == 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_lane_bounds_it(side: float) -> None:
    assert _offset([_beside(0.0, side)]) == pytest.approx(-ROOM * side)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_leaves_the_lane_only_as_far_as_it_must(side: float) -> None:
    assert _offset([_beside(-0.5, side)]) == pytest.approx(-(0.5 + place_in_lane.ENOUGH) * side)
    assert _offset([_beside(-ROOM - place_in_lane.BEYOND, side)]) == 0.0


def test_it_does_not_move_back_beside_somebody_because_it_has_moved_over() -> None:
    for along in (10.0, 5.0, 1.0):
        assert _offset([_beside(0.2, -1.0, along)], across=0.5) == pytest.approx(0.6)


def test_between_two_it_takes_the_middle() -> None:
    assert _offset([_beside(0.3, -1.0), _beside(0.5, 1.0)]) == pytest.approx(0.1)


def test_nobody_is_made_room_for_who_could_not_be_passed_or_enters_or_is_far() -> None:
    assert _offset([_beside(-1.1, -1.0)]) == 0.0
    assert _offset([_beside(0.4, -1.0)], stays=False) == 0.0
    assert _offset([_beside(0.4, -1.0, along=80.0)]) == 0.0
    assert _offset([_beside(0.4, -1.0, along=-5.0)]) == 0.0
    assert _offset([]) == 0.0


def test_a_car_ahead_is_not_beside() -> None:
    assert _offset([_beside(0.5, -1.0)], [Car(30.0, 0.1)]) == pytest.approx(0.3)


def test_a_car_beside_is_kept_away_from() -> None:
    free = LANE_WIDTH - 0.5 * BODY.width - 0.5 * 2.4 - place_in_lane.TO_VEHICLES
    wide = Car(3.0, 3.0, width=2.4)
    assert _offset([_beside(0.2, -1.0)], [wide]) == pytest.approx(free - 0.5)


@pytest.mark.parametrize("speed", [0.0, -5.0])
def test_in_a_bend_a_car_that_stands_or_comes_on_the_outer_side_leaves_less_room(speed: float) -> None:
    """The front of the ego swings out towards it."""
    corner = Walker(16.0, -1.25)
    meets = Car(20.0, 3.2, along_speed=speed, heading_error=np.pi)
    leads = Car(20.0, 3.2, along_speed=5.0)
    assert _offset([corner], [meets]) == _offset([corner])
    assert _offset([corner], [leads], road=TURN) == _offset([corner], road=TURN)
    assert _offset([corner], [meets], road=TURN) < _offset([corner], road=TURN) - 0.1


def test_a_steering_plan_keeps_to_it_from_three_metres_on() -> None:
    along = np.array([0.0, 1.5, 3.0, 10.0])
    corridor = np.full(4, -0.7), np.full(4, 1.6)
    right, left = place_in_lane.kept(corridor, 0.5, ego(speed=1.0, across=0.15), along)
    assert right == pytest.approx([0.15, 0.3, 0.45, 0.45])
    assert left == pytest.approx(corridor[1] - 0.5), "where the body would leave the lane"
    right, left = place_in_lane.kept(corridor, -0.5, ego(speed=1.0), along)
    assert right == pytest.approx([-0.55] * 4), "the place itself"
    assert left == pytest.approx([0.0, -0.225, -0.45, -0.45])
    assert place_in_lane.kept(corridor, 0.0, ego(), along) is corridor


def _nose(over: float, along: float = 20.0, speed: float = 0.0) -> Car:
    """A car across the road on the right, with its nose so far over the right flank of the ego [m]."""
    middle = over - 0.5 * BODY.width - 0.5 * 4.5
    return Car(along, middle, across_speed=speed, heading_error=0.5 * np.pi, length=4.5)


def test_a_standing_car_that_juts_in_is_passed_beside() -> None:
    assert _offset([], [_nose(0.0)]) == pytest.approx(place_in_lane.WANTED - place_in_lane.NEARER)
    assert _offset([], [_nose(0.9)]) == pytest.approx(0.9 + place_in_lane.TO_VEHICLES)
    assert _offset([], [_nose(-0.7)]) == 0.0, "it is far enough away"


@pytest.mark.parametrize(("gap", "moved"), [(1.2, 0.0), (1.6, 1.6 - place_in_lane.ENOUGH), (1.9, 1.2)])
def test_for_a_car_the_ego_does_not_move_too_near_to_people_on_the_other_side(
    gap: float, moved: float
) -> None:
    assert _offset([], [_nose(0.9)]) == pytest.approx(1.2)
    assert _offset([_beside(gap, 1.0)], [_nose(0.9)]) == pytest.approx(moved)


def test_a_car_that_juts_in_too_far_or_drives_or_is_followed_is_not() -> None:
    assert _offset([], [_nose(1.6)]) == 0.0
    assert _offset([], [_nose(0.9, speed=1.0)]) == 0.0
    assert _offset([], [_nose(0.9, along=80.0)]) == 0.0
    assert _offset([], [Car(20.0, -0.8)]) == 0.0
