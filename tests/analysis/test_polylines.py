"""Lines and outlines in the plane."""

import math

import numpy as np
import pytest
from shapely import Polygon, contains_xy

from analysis.polylines import arc_lengths, crossing_point, inside


def test_the_way_along_a_line_is_the_sum_of_its_pieces() -> None:
    assert arc_lengths(np.array([[1.0, 1.0], [4.0, 5.0], [4.0, 5.0], [4.0, -1.0]])).tolist() == [0, 5, 5, 11]


def test_the_meeting_of_two_lines_is_found() -> None:
    path = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
    meeting = crossing_point(path, np.array([[14.0, -5.0], [14.0, 5.0]]))
    assert meeting is not None
    station, direction, axis = meeting
    assert station == pytest.approx(14.0)
    assert math.atan2(direction[1], direction[0]) == pytest.approx(0.0)
    assert abs(axis[1]) == pytest.approx(1.0)
    assert crossing_point(path, np.array([[14.0, 1.0], [14.0, 5.0]])) is None


@pytest.mark.parametrize("closed", [False, True])
def test_points_are_inside_where_a_library_has_them(closed: bool) -> None:
    outline = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [3.0, 1.0], [0.0, 4.0]])
    points = np.random.default_rng(1).uniform(-1.0, 7.0, size=(500, 2))
    expected = contains_xy(Polygon(outline), points)
    assert 0 < expected.sum() < len(points)
    given = np.concatenate([outline, outline[:1]]) if closed else outline
    assert (inside(given, points) == expected).all()


def test_nothing_is_inside_a_line() -> None:
    assert not inside(np.array([[0.0, 0.0], [2.0, 2.0]]), np.array([[1.0, 1.0], [0.0, 1.0]])).any()
