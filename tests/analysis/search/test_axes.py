"""Axes, points and how far they are apart."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.search.axes import Axis, Point, distance, point, shares

SPEED = Axis("speed_mps", 0.5, 2.5)
SIZE = Axis("size", 1.0, 3.0, whole=True)
SIDE = Axis("side", choices=("left", "right"))


@given(st.floats(0.0, 1.0))
def test_a_value_lies_on_its_axis_and_its_share_leads_back_to_it(share: float) -> None:
    for axis in (SPEED, SIZE, SIDE):
        value = axis.value(share)
        assert axis.value(axis.share(value)) == value
    assert 0.5 <= float(SPEED.value(share)) <= 2.5
    assert SIZE.value(share) in (1, 2, 3)


def test_whole_numbers_and_choices_have_parts_of_the_same_length() -> None:
    assert [SIZE.value(share) for share in (0.0, 0.33, 0.34, 0.66, 0.67, 1.0)] == [1, 1, 2, 2, 3, 3]
    assert [SIDE.value(share) for share in (0.49, 0.51)] == ["left", "right"]


def test_a_point_has_a_value_for_each_axis_and_an_array_of_shares() -> None:
    found = point([SPEED, SIZE, SIDE], [0.25, 0.5, 0.75])
    assert found == {"speed_mps": 1.0, "size": 2, "side": "right"}
    assert shares([SPEED, SIDE], [found]).tolist() == [[0.25, 0.75]]


def test_a_change_of_side_counts_as_much_as_the_whole_range_of_a_number() -> None:
    here: Point = {"speed_mps": 0.5, "side": "left"}
    axes = [SPEED, SIDE]
    assert distance(axes, here, {"speed_mps": 2.5, "side": "left"}) == pytest.approx(math.sqrt(0.5))
    assert distance(axes, here, {"speed_mps": 0.5, "side": "right"}) == pytest.approx(math.sqrt(0.5))
    assert distance(axes, here, here) == 0.0
