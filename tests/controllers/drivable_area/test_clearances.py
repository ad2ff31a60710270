"""Distances between moving bodies, judged by another library."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from shapely import affinity
from shapely.geometry import Point, Polygon, box

from controllers.drivable_area.clearances import Boxes, Shape, apart
from controllers.interface import Body

PLACE = some.floats(-12.0, 12.0)
ANGLE = some.floats(-3.1, 3.1)


def _rectangle(x: float, y: float, heading: float, rear: float, front: float, width: float) -> Polygon:
    straight = box(rear, -0.5 * width, front, 0.5 * width)
    turned = affinity.rotate(straight, heading, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, x, y)


def _one(value: float) -> np.ndarray:
    return np.array([[value]])


@given(PLACE, PLACE, ANGLE, PLACE, PLACE)
def test_the_clearance_of_a_rectangle(x: float, y: float, heading: float, px: float, py: float) -> None:
    found = Shape(Body()).clearance(_one(x), _one(y), _one(heading), _one(px), _one(py))[0, 0]
    body = _rectangle(x, y, heading, -0.95, 3.55, 1.8)
    point = Point(px, py)
    outside = body.distance(point)
    expected = (outside if outside > 0.0 else -body.exterior.distance(point)) - 0.35
    assert found == pytest.approx(expected, abs=1e-9)


@given(PLACE, PLACE, ANGLE, PLACE, PLACE)
def test_the_clearance_of_the_disc_of_the_paper(
    x: float, y: float, heading: float, px: float, py: float
) -> None:
    shape = Shape(Body(), disc_radius=1.6)
    found = shape.clearance(_one(x), _one(y), _one(heading), _one(px), _one(py))[0, 0]
    assert found == pytest.approx(Point(x, y).distance(Point(px, py)) - 1.95, abs=1e-9)


@given(PLACE, PLACE, ANGLE, PLACE, PLACE, ANGLE)
def test_rectangles_are_apart_exactly_where_they_do_not_overlap(
    x: float, y: float, heading: float, ox: float, oy: float, turned: float
) -> None:
    others = Boxes(_one(ox), _one(oy), np.array([turned]), np.array([2.25]), np.array([0.9]))
    gap = float(apart(_one(x), _one(y), _one(heading), Body(), others)[0, 0, 0])
    own = _rectangle(x, y, heading, -0.95, 3.55, 1.8)
    other = _rectangle(ox, oy, turned, -2.25, 2.25, 1.8)
    distance = own.distance(other)
    assert gap <= distance + 1e-9
    assert (gap > 1e-9) == (distance > 1e-9) or abs(gap) < 1e-6


@given(some.floats(-4.0, 4.0), some.floats(-0.6, 0.6))
def test_what_juts_out_over_the_edges(across: float, heading: float) -> None:
    found = Shape(Body()).beyond_edges(np.array([across]), np.array([heading]), -1.75, 5.25)[0]
    _, low, _, high = _rectangle(0.0, across, heading, -0.95, 3.55, 1.8).bounds
    assert found == pytest.approx(max(high - 5.25, -1.75 - low), abs=1e-9)
