"""The collision cone against its own definition and against shapely."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, box

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.cones import clearance, rectangle_tangent, tangent

HALF_LENGTH, HALF_WIDTH = 2.25, 0.9


def _cases(count: int, seed: int, nearest: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    drawn = np.random.default_rng(seed)
    angle = drawn.uniform(-np.pi, np.pi, count)
    distance = drawn.uniform(nearest, 40.0, count)
    wx, wy = drawn.normal(size=(2, count)) * 6.0
    return distance * np.cos(angle), distance * np.sin(angle), wx, wy


def threatens(
    px: FloatArray, py: FloatArray, wx: FloatArray, wy: FloatArray, radius: float
) -> NDArray[np.bool_]:
    """Return whether the relative velocity lies inside the cone: ``|wrap(theta - alpha)| < asin(r / d)``.

    Notes
    -----
    Eq. (16) of [VOMPC2019]_ is printed one-sided with the principal arctangent; read literally it rejects
    both of the paper's own solutions. The two-sided form with the full angle is used.
    """
    distance = np.hypot(px, py)
    inside = distance <= radius
    half = np.arcsin(np.clip(radius / np.maximum(distance, 1e-12), 0.0, 1.0))
    difference = np.arctan2(wy, wx) - np.arctan2(py, px)
    wrapped = (difference + np.pi) % (2.0 * np.pi) - np.pi
    return inside | (np.abs(wrapped) < half)


def _beyond(px: FloatArray, py: FloatArray, wx: FloatArray, wy: FloatArray, side: float) -> FloatArray:
    sides = np.full(len(px), side)
    return clearance(*tangent(px, py, 2.0, sides), wx, wy, sides)


def test_the_two_half_planes_cover_exactly_what_the_cone_leaves() -> None:
    px, py, wx, wy = _cases(20000, 1, 2.01)
    left, right = _beyond(px, py, wx, wy, 1.0), _beyond(px, py, wx, wy, -1.0)
    either = np.maximum(left, right) >= 0.0
    assert np.array_equal(either, ~threatens(px, py, wx, wy, 2.0))
    assert either.any()
    assert not either.all()


def test_a_velocity_in_the_cone_of_a_disc_meets_the_disc_and_no_other_does() -> None:
    px, py, wx, wy = _cases(3000, 2, 2.01)
    hit = threatens(px, py, wx, wy, 2.0)
    for i in range(len(px)):
        ray = LineString([(0.0, 0.0), (1e3 * wx[i], 1e3 * wy[i])])
        assert hit[i] == (ray.distance(Point(px[i], py[i])) < 2.0)


def test_the_tangent_touches_the_disc_with_the_length_it_promises() -> None:
    px, py, *_ = _cases(500, 3, 2.5)
    for side in (1.0, -1.0):
        x, y = tangent(px, py, 2.0, np.full(len(px), side))
        assert np.allclose(np.hypot(x, y), px**2 + py**2)
        # Distance of the centre from the ray, on the side that is not passed.
        assert np.allclose((x * py - y * px) / np.hypot(x, y), -side * 2.0)


def test_whoever_is_inside_the_disc_is_a_threat_and_only_leaving_is_free() -> None:
    px, py = np.array([1.0, 1.0]), np.zeros(2)
    assert threatens(px, py, np.array([-1.0, 5.0]), np.zeros(2), 2.0).all()
    # Inside, the tangent is perpendicular to the line of sight.
    x, y = tangent(px, py, 2.0, np.array([1.0, -1.0]))
    assert np.allclose(x, 0.0)
    assert np.allclose(y, [2.0, -2.0])


def test_the_tangent_of_a_rectangle_is_that_of_its_grown_outline() -> None:
    px, py, *_ = _cases(400, 4, 3.5)
    radius = 0.25
    grown = box(-HALF_LENGTH, -HALF_WIDTH, HALF_LENGTH, HALF_WIDTH).buffer(radius, quad_segs=256)
    outline = np.asarray(grown.exterior.coords)
    for side in (1.0, -1.0):
        sides = np.full(len(px), side)
        x, y = rectangle_tangent(px, py, HALF_LENGTH, HALF_WIDTH, radius, sides)
        assert np.allclose(np.hypot(x, y), 1.0)
        for i in range(len(px)):
            # Directions from the origin to the outline about the pedestrian, relative to its centre's.
            points = outline + np.array([px[i], py[i]])
            bearing = np.arctan2(px[i] * points[:, 1] - py[i] * points[:, 0], points @ (px[i], py[i]))
            ray = np.arctan2(px[i] * y[i] - py[i] * x[i], px[i] * x[i] + py[i] * y[i])
            assert side * ray == pytest.approx((side * bearing).max(), abs=2e-4)


def test_a_rectangle_without_extent_is_a_disc() -> None:
    px, py, *_ = _cases(100, 5, 2.5)
    side = np.where(np.arange(100) % 2, 1.0, -1.0)
    x, y = tangent(px, py, 2.0, side)
    norm = np.hypot(x, y)
    assert np.allclose(rectangle_tangent(px, py, 0.0, 0.0, 2.0, side), (x / norm, y / norm))


@pytest.mark.parametrize(("walks", "begins"), [(1.3, -4.0), (-1.3, 4.0)])
def test_a_fast_ego_passes_ahead_on_the_left_of_somebody_who_walks_to_the_left(
    walks: float, begins: float
) -> None:
    """The side of passing ahead is the sign of the walk; a slow ego is on the other side, behind."""
    px, py = np.array([30.0]), np.array([begins])
    for speed, passes in ((25.0, "ahead"), (1.0, "behind")):
        # At this speed the ego crosses the walker's path before (after) the walker does.
        assert (30.0 / speed < abs(begins / walks)) == (passes == "ahead")
        side = np.array([np.sign(walks) * (1.0 if passes == "ahead" else -1.0)])
        w = np.array([speed]), np.array([-walks])
        assert clearance(*tangent(px, py, 2.0, side), *w, side)[0] > 0.0
        assert clearance(*tangent(px, py, 2.0, -side), *w, -side)[0] < 0.0
