"""Points seen from lanes."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.sumo.lanes import LaneShape


def lane(*points: tuple[float, float], length: float | None = None) -> LaneShape:
    stations = [0.0]
    for start, end in pairwise(points):
        stations.append(stations[-1] + math.dist(start, end))
    return LaneShape("e_0", "e", 0, 3.2, length or stations[-1], points, tuple(stations))


BEND = lane((0.0, 0.0), (50.0, 0.0), (50.0, 40.0))


def test_left_of_a_lane_is_positive() -> None:
    place = BEND.place(20.0, 1.5)
    assert (place.along, place.across) == (20.0, 1.5)
    assert BEND.place(51.0, 20.0).across == pytest.approx(-1.0)


def test_beyond_the_ends_the_lane_is_prolonged() -> None:
    assert BEND.place(-5.0, 1.0).along == pytest.approx(-5.0)
    assert BEND.place(50.0, 47.0).along == pytest.approx(97.0)


def test_a_counted_length_that_differs_from_the_shape_scales_positions() -> None:
    assert lane((0.0, 0.0), (50.0, 0.0), length=60.0).scale == pytest.approx(1.2)


def test_of_a_lane_without_extent_every_point_is_beyond() -> None:
    point = lane((10.0, 0.0), (10.0, 0.0), length=0.1)
    assert point.place(12.0, 0.0).along > point.shape_length


@given(st.floats(1.0, 45.0), st.floats(-2.0, 2.0))
def test_a_place_leads_back_to_its_point(along: float, across: float) -> None:
    place = BEND.place(*BEND.point(along, across))
    assert (place.along, place.across) == pytest.approx((along, across), abs=1e-9)
