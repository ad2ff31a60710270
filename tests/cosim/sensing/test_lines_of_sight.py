"""Lines of sight, with shapely as the judge."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely import MultiPoint, Polygon, affinity, box
from shapely.geometry.base import BaseGeometry

from cosim.arrays import BoolArray, FloatArray
from cosim.sensing import lines_of_sight

NO_WALLS = np.zeros((0, 4))
NO_BOXES = lines_of_sight.boxes_of(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0))
GRAZE = 1e-7
"""A line that touches a corner by less than this may be judged either way [m]."""


def _body(front: FloatArray, heading: float, length: float, width: float) -> Polygon:
    straight = box(-length, -0.5 * width, 0.0, 0.5 * width)
    turned = affinity.rotate(straight, heading, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, *front)


def _judged(
    eye: FloatArray, centre: FloatArray, radius: FloatArray, shapes: list[BaseGeometry]
) -> list[bool | None]:
    """Return for each disc whether one of the three lines to it is free of all shapes.

    ``None`` where one of the lines grazes some shape: a corner is on the line, or the line ends on a side.
    """
    away = centre - eye
    beside = radius[:, None] * np.column_stack([-away[:, 1], away[:, 0]]) / np.hypot(*away.T)[:, None]
    ends = centre[:, None] + np.array([0.0, 1.0, -1.0])[:, None] * beside[:, None]
    both = np.stack([np.broadcast_to(eye, ends.shape), ends], axis=-2)
    lines, tips = (np.asarray(make(both))[..., None] for make in (shapely.linestrings, shapely.multipoints))
    sides = [shape.exterior if isinstance(shape, Polygon) else shape for shape in shapes]
    corners = [MultiPoint(list(side.coords)) for side in sides]
    near_corner, on_side = shapely.distance(lines, corners), shapely.distance(sides, tips)
    grazes: BoolArray = np.asarray((near_corner < GRAZE) | (on_side < GRAZE), dtype=bool)
    blocked: BoolArray = np.asarray(shapely.intersects(lines, shapes), dtype=bool)
    return [
        None if touched.any() else bool((hit.sum(axis=-1) == 0).any())
        for touched, hit in zip(grazes, blocked, strict=True)
    ]


def _sides(outline: FloatArray) -> FloatArray:
    return np.hstack([outline, np.roll(outline, -1, axis=0)])


@pytest.mark.parametrize("seed", range(20))
def test_thousands_of_random_scenes_are_seen_as_shapely_sees_them(seed: int) -> None:
    draw = np.random.default_rng(seed)
    seen_so_far = judged_so_far = 0
    for _ in range(60):
        vehicles, discs = int(draw.integers(0, 12)), 8
        eye = draw.uniform(-5.0, 5.0, 2)
        front, heading = draw.uniform(-40.0, 40.0, (vehicles, 2)), draw.uniform(-4.0, 4.0, vehicles)
        length, width = draw.uniform(2.0, 15.0, vehicles), draw.uniform(0.8, 2.6, vehicles)
        position, radius = draw.uniform(-60.0, 60.0, (discs, 2)), draw.uniform(0.1, 0.5, discs)
        outlines = [_house(draw) for _ in range(int(draw.integers(0, 3)))]
        shapes: list[BaseGeometry] = [_body(*one) for one in zip(front, heading, length, width, strict=True)]
        # Of a house its walls are in the way; who is inside with the eye is seen.
        shapes += [Polygon(outline).exterior for outline in outlines]
        boxes = lines_of_sight.boxes_of(front, heading, length, width)
        walls = np.concatenate([NO_WALLS, *(_sides(outline) for outline in outlines)])
        seen = lines_of_sight.visible(eye, position, radius, boxes, walls)
        for one, judged in enumerate(_judged(eye, position, radius, shapes)):
            if judged is not None:
                judged_so_far += 1
                seen_so_far += judged
                assert seen[one] == judged
    # Both answers are common, and hardly a line grazes anything.
    assert judged_so_far > 0.99 * 60 * 8
    assert 0.2 < seen_so_far / judged_so_far < 0.9


def _house(draw: np.random.Generator) -> FloatArray:
    """Return a polygon of any shape whose sides do not cross, hollows included."""
    corners = int(draw.integers(3, 8))
    angle = np.sort(draw.uniform(0.0, 2.0 * math.pi, corners))
    reach = draw.uniform(2.0, 12.0, corners)
    centre = draw.uniform(-30.0, 30.0, 2)
    return np.asarray(centre + reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def test_the_edge_that_comes_out_first_is_seen() -> None:
    # The box's corner is at (5, 1); the line over it is at y = 4 where x is 20.
    corner = lines_of_sight.boxes_of(np.array([[10.0, 0.0]]), np.zeros(1), np.array([5.0]), np.array([2.0]))

    def seen(y: float) -> bool:
        return bool(
            lines_of_sight.visible(np.zeros(2), np.array([[20.0, y]]), np.array([0.25]), corner, NO_WALLS)[0]
        )

    assert not seen(3.70)
    assert seen(3.80)
    assert seen(4.10)


def test_nothing_in_the_way_and_nobody_there() -> None:
    assert (
        lines_of_sight.visible(np.zeros(2), np.zeros((0, 2)), np.zeros(0), NO_BOXES, NO_WALLS).tolist() == []
    )
    far = np.array([[1000.0, 3.0]])
    assert lines_of_sight.visible(np.zeros(2), far, np.full(1, 0.25), NO_BOXES, NO_WALLS).tolist() == [True]


def test_range_and_field_of_view() -> None:
    places = np.array([[50.0, 0.0], [61.0, 0.0], [10.0, 17.0], [10.0, 18.0], [-10.0, 0.0]])
    north = math.pi / 2
    turned = np.column_stack([-places[:, 1], places[:, 0]])
    for heading, there in ((0.0, places), (north, turned)):
        found = lines_of_sight.in_view(np.zeros(2), heading, there, 60.0, math.radians(120.0))
        assert found.tolist() == [True, False, True, False, False]
        around = lines_of_sight.in_view(np.zeros(2), heading, there, 60.0, math.radians(360.0))
        assert around.tolist() == [True, False, True, True, True]


def test_the_distance_to_a_road() -> None:
    road = np.array([[0.0, 0.0, 100.0, 0.0], [100.0, 0.0, 100.0, 50.0]])
    assert lines_of_sight.distance_to_pieces(50.0, -7.0, road) == pytest.approx(7.0)
    assert lines_of_sight.distance_to_pieces(-3.0, 4.0, road) == pytest.approx(5.0)
    assert lines_of_sight.distance_to_pieces(108.0, 40.0, road) == pytest.approx(8.0)
