"""SUMO's degrees and front bumpers against radians and rear axles."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.step.frames import degrees_of, front_of, heading_of, rear_axle_of, wrapped

angles = st.floats(-20.0, 20.0)
lengths = st.floats(-1e4, 1e4)


@pytest.mark.parametrize(
    ("degrees", "heading"),
    [(0.0, math.pi / 2), (90.0, 0.0), (180.0, -math.pi / 2), (270.0, math.pi), (45.0, math.pi / 4)],
)
def test_north_east_south_and_west_have_the_headings_of_a_compass(degrees: float, heading: float) -> None:
    assert heading_of(degrees) == pytest.approx(heading)
    assert degrees_of(heading) == pytest.approx(degrees)


@given(angles)
def test_a_heading_survives_the_way_to_sumo_and_back(heading: float) -> None:
    assert abs(wrapped(heading_of(degrees_of(heading)) - heading)) < 1e-9
    assert 0.0 <= degrees_of(heading) < 360.0
    assert -math.pi < wrapped(heading) <= math.pi


@given(lengths, lengths, angles, st.floats(0.0, 20.0))
def test_the_rear_axle_survives_the_way_to_the_bumper_and_back(
    x: float, y: float, heading: float, front: float
) -> None:
    back = rear_axle_of(*front_of(x, y, heading, front), heading, front)
    assert back == pytest.approx((x, y), abs=1e-9)


def test_facing_north_the_bumper_is_north_of_the_axle() -> None:
    assert front_of(10.0, 20.0, math.pi / 2, 3.55) == pytest.approx((10.0, 23.55))
