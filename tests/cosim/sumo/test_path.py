"""The smooth curve along a lane."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.arrays import FloatArray
from cosim.sumo.path import ASKED_AGAIN, Path, interpolated, project_all

BEND = np.array([[-60.0, 0.0], [0.0, 0.0], [6.0, 1.0], [10.0, 5.0], [11.0, 11.0], [11.0, 80.0]])


def test_a_straight_line_is_kept_as_it_is() -> None:
    path = Path(np.array([[-50.0, 3.0], [0.0, 3.0], [100.0, 3.0]]), origin=-50.0)
    along, across, heading = path.project(np.array([[30.0, 5.0], [-80.0, 2.0], [140.0, 3.0]]))
    assert along == pytest.approx([30.0, -80.0, 140.0])
    assert across == pytest.approx([2.0, -1.0, 0.0])
    assert heading == pytest.approx([0.0, 0.0, 0.0])
    assert np.abs(path.curvature).max() < 1e-9


def test_a_circle_has_its_radius() -> None:
    angle = np.linspace(0.0, 1.5, 40)
    path = Path(20.0 * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)]))
    inside = path.curvature[10:-10]
    assert inside == pytest.approx(1.0 / 20.0, rel=0.05)


@given(st.floats(-55.0, 75.0), st.floats(-3.0, 3.0))
def test_projection_is_the_inverse_of_placing(along: float, across: float) -> None:
    path = Path(BEND, origin=-60.0)
    point = path.at(np.array([along]), np.array([across]))
    found = path.project(point)
    assert found[0][0] == pytest.approx(along, abs=1e-6)
    assert found[1][0] == pytest.approx(across, abs=1e-6)


@given(st.lists(st.tuples(st.floats(-70.0, 120.0), st.floats(-3.0, 3.0)), min_size=2, max_size=6))
def test_one_point_is_placed_to_the_last_digit_where_it_is_among_others(
    places: list[tuple[float, float]],
) -> None:
    path = Path(BEND, origin=-60.0)
    along, across = np.array(places).T
    one_by_one = [path.at(along[i : i + 1], across[i : i + 1])[0] for i in range(len(along))]
    assert np.array_equal(path.at(along, across), one_by_one)


@given(st.floats(-70.0, 90.0), st.floats(-3.0, 3.0), st.floats(-4.0, 4.0))
def test_a_guess_gives_the_same_place_as_a_search(along: float, across: float, error: float) -> None:
    path = Path(BEND, origin=-60.0)
    (x, y), *_ = path.at(np.array([along]), np.array([across]))
    assert path.place_near(x, y, along + error) == pytest.approx((along, across), abs=1e-6)


def test_points_of_several_paths_are_found_as_those_of_each_path() -> None:
    """To the last bit: a recording is the same whoever else drives beside an ego."""
    random = np.random.default_rng(1)
    paths = [Path(BEND, origin=-60.0), Path(BEND + 3.0), Path(BEND[::-1])]
    counts = [7, 0, 40]
    points = random.uniform(-80.0, 90.0, (sum(counts), 2))
    together = project_all(paths, points, counts)
    alone = [paths[0].project(points[:7]), paths[1].project(points[7:7]), paths[2].project(points[7:])]
    for values, parts in zip(together, zip(*alone, strict=True), strict=True):
        assert values.tobytes() == np.concatenate(parts).tobytes()


@given(
    st.floats(-3.0, 12.0) | st.integers(-3, 12).map(float),
    st.lists(st.floats(-50.0, 50.0) | st.just(math.nan), min_size=10, max_size=10),
)
def test_one_number_is_interpolated_as_numpy_does(at: float, values: list[float]) -> None:
    places = np.cumsum([0.0, 0.1, 0.7, 1.3, 1.0 / 3.0, 0.5, 2.0, 0.1, 1.1, 1.0])
    found, expected = interpolated(at, places, np.array(values)), float(np.interp(at, places, values))
    assert found == expected or (math.isnan(found) and math.isnan(expected))


def test_corners_are_cut_by_little() -> None:
    path = Path(BEND, origin=-60.0)
    dense = np.concatenate([np.linspace(start, end, 50) for start, end in pairwise(BEND)])
    assert np.abs(path.project(dense)[1]).max() < 0.5


ROUND_THE_BLOCK = np.array([[0.0, 0.0], [60.0, 0.0], [60.0, 50.0], [0.0, 50.0], [0.0, 0.0], [60.0, 0.0]])


@pytest.mark.parametrize(("near", "along"), [(5.0, 30.0), (200.0, 250.0)])
def test_where_a_path_comes_along_the_same_road_again_the_passage_near_the_ego_counts(
    near: float, along: float
) -> None:
    path = Path(ROUND_THE_BLOCK)
    points = np.array([[30.0, 0.4], [60.4, 25.0]])
    found, across, _ = project_all([path], points, [2], [near])
    assert found[0] == pytest.approx(along, abs=5.0), "corners are cut"
    assert found[1] == pytest.approx(85.0, abs=5.0), "there it passes once"
    assert across == pytest.approx([0.4, -0.4], abs=0.05)


@pytest.mark.parametrize("line", [BEND, ROUND_THE_BLOCK], ids=["bend", "round the block"])
def test_points_that_are_asked_for_again_are_where_they_were(line: FloatArray) -> None:
    """To the last bit, however many others were asked for in between and wherever the asker is by then."""
    path, random = Path(line), np.random.default_rng(2)
    sets = [random.uniform(-80.0, 90.0, (5, 2)) for _ in range(ASKED_AGAIN + 10)]
    for near in (0.0, 0.0, 200.0):
        for points in sets:
            found = path.project_again(points, near)
            expected = project_all([path], points, [len(points)], [near])[:2]
            assert [values.tobytes() for values in found] == [values.tobytes() for values in expected]


def test_a_lane_beside_the_one_of_the_next_passage_is_still_beside_this_one() -> None:
    """The second time round the path is in the lane to the left, where somebody stands ahead."""
    path = Path(np.vstack((ROUND_THE_BLOCK[:-2], [[-3.2, 3.2], [60.0, 3.2]])))
    found, across, _ = project_all([path], np.array([[30.0, 3.0]]), [1], [5.0])
    assert found[0] == pytest.approx(30.0, abs=1.0)
    assert across[0] == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize(
    ("near", "first"), [(5.0, True), (60.0, False)], ids=["on the way out", "before the turn"]
)
def test_who_stands_on_the_way_back_is_beside_the_way_out_before_being_ahead_on_it(
    near: float, first: bool
) -> None:
    """Unless that part of the way out has been driven."""
    hairpin = Path(np.array([[0.0, 0.0], [60.0, 0.0], [63.0, 1.6], [60.0, 3.2], [0.0, 3.2]]))
    found, across, _ = project_all([hairpin], np.array([[30.0, 3.1]]), [1], [near])
    assert (found[0] < 31.0) == first
    assert (found[0] > 80.0) != first
    assert across[0] == pytest.approx(3.1 if first else 0.1, abs=0.1)


def test_a_vehicle_that_waits_across_the_way_is_there_and_not_where_the_path_comes_across_later() -> None:
    """With its front it stands where the path, round the block, crosses the junction a second time."""
    path = Path(np.array([[0.0, 0.0], [80.0, 0.0], [80.0, 50.0], [30.0, 50.0], [30.0, -40.0]]))
    front, rear = [30.1, 4.0], [28.0, -0.5]
    found, across, heading = project_all([path], np.array([front, rear]), [2], [5.0])
    assert found == pytest.approx([30.1, 28.0], abs=0.1)
    assert across == pytest.approx([4.0, -0.5], abs=0.1)
    assert heading == pytest.approx([0.0, 0.0], abs=0.01)
    later, _, _ = project_all([path], np.array([front]), [1], [150.0])
    assert later[0] > 200.0
