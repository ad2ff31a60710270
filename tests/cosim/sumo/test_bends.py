"""Bends tighter than a car can drive."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis.polylines import arc_lengths
from controllers.interface import Body
from cosim.step.plant import CAR_DRIVE, body_of
from cosim.sumo.bends import CAR, RESERVE, highest_speed, turning_of, widened
from cosim.sumo.path import Path

TIGHT = st.floats(0.6, 3.0)


def corner(turn: float, behind: float = 60.0) -> Path:
    """Return the path round a bare corner at (0, 0): from the west, turned by so much [rad]."""
    onward = behind * np.array([math.cos(turn), math.sin(turn)])
    return Path(np.array([[-60.0, 0.0], [0.0, 0.0], onward]), origin=-60.0)


def arc(radius: float, turn: float) -> Path:
    """Return the path along an arc between two straights."""
    angle = np.linspace(0.0, turn, 200)
    circle = radius * math.copysign(1.0, turn) * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    onward = circle[-1] + 40.0 * np.array([math.cos(turn), math.sin(turn)])
    return Path(np.concatenate([[[-40.0, 0.0]], circle, [onward]]))


@pytest.mark.parametrize("path", [arc(8.0, 1.5), arc(5.0, -1.5), corner(0.3), corner(-0.4)])
def test_a_path_that_the_car_can_drive_is_left_alone(path: Path) -> None:
    assert widened(path, CAR) == (path, ())


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(TIGHT, st.sampled_from([-1.0, 1.0]))
def test_what_was_too_tight_can_be_driven_and_has_no_corner(turn: float, side: float) -> None:
    lanes = corner(side * turn)
    path, bends = widened(lanes, CAR)
    if not bends:
        assert np.abs(lanes.curvature).max() <= 1.0 / CAR.radius
        return
    curvature = np.gradient(path.heading, path.along)
    assert 1.0 / np.abs(curvature).max() > CAR.radius
    # Tangents: from sample to sample the direction turns by no more than on the tightest circle.
    turned = np.abs(np.diff(path.heading))
    assert (turned <= np.diff(path.along) / CAR.radius + 1e-9).all()
    assert path.heading[-1] - path.heading[0] == pytest.approx(side * turn, abs=1e-6)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(TIGHT, st.sampled_from([-1.0, 1.0]))
def test_stations_go_on_and_are_those_of_the_lanes_before_and_behind(turn: float, side: float) -> None:
    lanes = corner(side * turn)
    path, bends = widened(lanes, CAR)
    assert (np.diff(path.stations) > 0.0).all()
    assert (np.diff(path.along) > 0.0).all()
    for bend in bends:
        for station in (-50.0, bend.start - 3.0, bend.end + 3.0, 50.0):
            there = lanes.at(np.array([lanes.station_along(station)]), np.zeros(1))
            here = path.at(np.array([path.station_along(station)]), np.zeros(1))
            assert here == pytest.approx(there, abs=0.02)


def test_a_right_angle_is_cut_so_that_rear_and_front_are_as_far_from_the_lanes() -> None:
    path, (bend,) = widened(corner(0.5 * math.pi), CAR)
    # The front bumper cannot get less far out: sqrt(R^2 + front^2) - R.
    radius = RESERVE * CAR.radius
    assert bend.off == pytest.approx(math.hypot(radius, CAR.front) - radius, abs=0.2)
    # Of the two straights the nearer one is how far the rear axle is off.
    rear = np.minimum(np.abs(path.points[:, 0]), np.abs(path.points[:, 1]))
    assert 1.0 < rear.max() < bend.off


def test_a_hairpin_is_swung_round() -> None:
    lanes = Path(np.array([[-60.0, 0.0], [0.0, 0.0], [0.0, 3.2], [-60.0, 3.2]]), origin=-60.0)
    path, (bend,) = widened(lanes, CAR)
    assert 1.0 / np.abs(path.curvature).max() > CAR.radius
    assert path.points[:, 1].min() < -0.5
    assert path.points[:, 1].max() > 3.7
    assert bend.off < 4.5


@pytest.mark.parametrize("apart", [3.0, 6.0, 9.0, 12.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_bends_near_each_other_are_driven_as_one(apart: float, side: float) -> None:
    points = np.array([[-60.0, 0.0], [0.0, 0.0], [0.0, apart], [side * 60.0, apart]])
    path, bends = widened(Path(points, origin=-60.0), CAR)
    assert len(bends) == 1
    assert 1.0 / np.abs(path.curvature).max() > CAR.radius


@pytest.mark.parametrize("apart", [16.0, 18.0, 25.0, 40.0])
def test_two_bends_are_each_drawn_anew(apart: float) -> None:
    points = np.array([[-60.0, 0.0], [0.0, 0.0], [0.0, apart], [60.0, apart]])
    path, bends = widened(Path(points, origin=-60.0), CAR)
    assert len(bends) == 2
    assert bends[0].end < bends[1].start
    assert np.diff(path.stations).min() > 0.0
    assert 1.0 / np.abs(path.curvature).max() > CAR.radius


def test_a_long_vehicle_needs_more_room_than_a_car() -> None:
    bus = turning_of(body_of(12.0, 2.5), CAR_DRIVE)
    lanes = arc(6.0, 0.5 * math.pi)
    assert widened(lanes, CAR)[1] == ()
    path, (bend,) = widened(lanes, bus)
    assert 1.0 / np.abs(path.curvature).max() > bus.radius > 9.0
    assert bend.off > 1.5


def test_a_bend_that_reverses_is_slower_than_one_that_does_not() -> None:
    turn, back = arc(4.2, 1.0), Path(np.array([[-40.0, 0.0], [0.0, 0.0], [3.0, 3.0], [40.0, 3.0]]))
    assert highest_speed(turn, 0.0, 80.0, CAR) > highest_speed(back, 0.0, 80.0, CAR)
    straight = Path(np.array([[0.0, 0.0], [50.0, 0.0]]))
    assert highest_speed(straight, 0.0, 50.0, CAR) > 100.0


def test_the_smallest_radius_is_that_of_the_rear_axle() -> None:
    turning = turning_of(Body(wheelbase=3.0), replace(CAR_DRIVE, max_steering=0.5))
    assert turning.radius == pytest.approx(3.0 / math.tan(0.5))


def test_points_on_the_way_are_half_a_metre_apart() -> None:
    _, (bend,) = widened(corner(2.0), CAR)
    assert np.diff(arc_lengths(bend.points)).max() <= 0.5 + 1e-9
