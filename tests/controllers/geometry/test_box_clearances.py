"""Distances of a car to rectangles, with shapely as the other judge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Polygon, box

from controllers.geometry.box_clearances import Boxes, box_clearances
from controllers.interface import Body

BODY = Body()
PLACE = st.floats(-9.0, 9.0)
HEADING = st.floats(-3.2, 3.2)


def _placed(shape: Polygon, x: float, y: float, heading: float) -> Polygon:
    return affinity.translate(affinity.rotate(shape, heading, (0.0, 0.0), use_radians=True), x, y)


@given(PLACE, PLACE, HEADING, PLACE, PLACE, HEADING, st.floats(0.5, 12.0), st.floats(0.3, 3.0))
def test_the_distance_to_a_box_is_that_of_shapely(
    x: float,
    y: float,
    heading: float,
    other_x: float,
    other_y: float,
    turned: float,
    long: float,
    wide: float,
) -> None:
    pose = (np.full((1, 1), x), np.full((1, 1), y), np.full((1, 1), heading))
    other = Boxes(*(np.array([value]) for value in (other_x, other_y, turned, long, wide)))
    car = _placed(box(-BODY.rear_overhang, -0.5 * BODY.width, BODY.front, 0.5 * BODY.width), x, y, heading)
    rectangle = _placed(box(-0.5 * long, -0.5 * wide, 0.5 * long, 0.5 * wide), other_x, other_y, turned)
    assert box_clearances(*pose, BODY, other)[0, 0, 0] == pytest.approx(car.distance(rectangle), abs=1e-9)


def test_a_box_across_the_body_overlaps_without_a_corner_in_it() -> None:
    here = np.zeros((1, 1))
    across = Boxes(*(np.array([value]) for value in (1.0, 0.0, np.pi / 2.0, 8.0, 0.5)))
    assert box_clearances(here, here, here, BODY, across)[0, 0, 0] == 0.0


def test_instants_paths_and_boxes_each_have_their_axis() -> None:
    instants, paths, boxes = 3, 2, 4
    x = np.arange(6.0).reshape(instants, paths)
    zero, many = np.zeros((instants, paths)), np.arange(boxes, dtype=float)
    found = box_clearances(x, zero, zero, BODY, Boxes(many + 10.0, many, 0.1 * many, many + 2.0, many + 1.0))
    assert found.shape == (instants, paths, boxes)
    one = Boxes(*(np.array([value]) for value in (13.0, 3.0, 0.3, 5.0, 4.0)))
    alone = box_clearances(x[2:, 1:], zero[:1, :1], zero[:1, :1], BODY, one)
    assert found[2, 1, 3] == pytest.approx(alone[0, 0, 0])
