"""Ways of bounded curvature between two poses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.sumo.arcs import LEFT, RIGHT, STRAIGHT, Pose, between

RADIUS = 4.2
ANGLES = st.floats(-math.pi, math.pi)


@given(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0), ANGLES, ANGLES)
def test_every_way_ends_where_it_has_to_and_turns_no_tighter(
    x: float, y: float, leaving: float, arriving: float
) -> None:
    start, end = Pose(3.0, -2.0, leaving), Pose(3.0 + x, y - 2.0, arriving)
    ways = list(between(start, end, RADIUS))
    assert ways
    for way in ways:
        points, headings = way.places(start, 0.1)
        assert points[-1] == pytest.approx([end.x, end.y], abs=1e-5)
        assert math.remainder(headings[-1] - end.heading, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5)
        steps = np.hypot(*np.diff(points, axis=0).T)
        assert steps.sum() == pytest.approx(way.length, abs=1e-2)
        assert (np.abs(np.diff(headings)) <= steps / RADIUS * 1.01 + 1e-9).all()


def test_a_corner_with_just_enough_room_is_one_arc() -> None:
    start, end = Pose(-RADIUS, 0.0, 0.0), Pose(0.0, RADIUS, 0.5 * math.pi)
    shortest = min(between(start, end, RADIUS), key=lambda way: way.length)
    assert shortest.length == pytest.approx(0.5 * math.pi * RADIUS)


def test_a_hairpin_without_room_swings_out_before_it_turns() -> None:
    start, end = Pose(0.0, 0.0, 0.0), Pose(0.0, 3.2, math.pi)
    shortest = min(between(start, end, RADIUS), key=lambda way: way.length)
    assert shortest.turns == (RIGHT, LEFT, RIGHT)


def test_straight_on_is_straight() -> None:
    shortest = min(between(Pose(0, 0, 0), Pose(20, 0, 0), RADIUS), key=lambda way: way.length)
    assert shortest.length == pytest.approx(20.0)
    assert STRAIGHT in shortest.turns
    assert LEFT in shortest.turns or RIGHT in shortest.turns
