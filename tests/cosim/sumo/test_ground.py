"""Where places are, with shapely as the judge."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import shapely

from cosim.sumo.ground import OUTSIDE, Ground
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from sumo_scenarios.library import load, prepare

from .conftest import build


def shapes(network: Network) -> Iterator[tuple[int, str, shapely.Geometry]]:
    """Yield rank, edge and area of all that has one."""
    for crossing in network.crossings.values():
        yield (
            0,
            crossing.name,
            shapely.LineString(crossing.axis).buffer(0.5 * crossing.width, cap_style="flat"),
        )
    for lane in network.lanes.values():
        area = shapely.LineString(lane.shape).buffer(0.5 * lane.width, cap_style="flat", join_style="mitre")
        yield 3 if lane.internal else 1, lane.edge, area
    for walking in network.walking_areas.values():
        yield 2, walking.name, shapely.Polygon(walking.outline).buffer(0.0)


@pytest.mark.long
def test_random_places_of_a_measured_junction_are_what_shapely_says(braunschweig: Network) -> None:
    ground = Ground(braunschweig)
    known = list(shapes(braunschweig))
    tree = shapely.STRtree([area for _, _, area in known])
    outlines = [shapely.boundary(area) for _, _, area in known]
    generator = np.random.default_rng(2)
    found, different = set(), 0
    for x, y in generator.uniform((60.0, 60.0), (400.0, 360.0), (3000, 2)).tolist():
        point = shapely.Point(x, y)
        inside = [(known[i][0], known[i][1]) for i in tree.query(point, predicate="intersects").tolist()]
        rank = min(inside, default=(4, ""))[0]
        edges = {name for one, name in inside if one == rank} or {""}
        spot = ground.at(x, y)
        found.add(rank)
        if spot.edge not in edges:
            # On a seam, or at the corner of a polyline, both answers are right.
            near = min(outlines[i].distance(point) for i in tree.query(point.buffer(1.0)).tolist())
            assert near < 0.6
            different += 1
        else:
            assert (spot.crossing != "") is (rank == 0)
    assert found == {0, 1, 2, 3, 4}
    assert different < 60


def test_who_is_too_far_from_everything_is_found(braunschweig: Network) -> None:
    ground = Ground(braunschweig)
    union = shapely.union_all([area for _, _, area in shapes(braunschweig)])
    points = np.random.default_rng(3).uniform((-100.0, -100.0), (550.0, 500.0), (1500, 2))
    away = np.asarray(shapely.distance(union, shapely.points(points)))
    certain = np.abs(away - OUTSIDE) > 0.5
    for point, distance in zip(points[certain], away[certain], strict=True):
        assert (ground.check_inside(point[None, :]) is not None) is bool(distance > OUTSIDE)
    assert 100 < (away > OUTSIDE).sum() < 1400
    inside = points[away < OUTSIDE - 1.0][:3]
    assert ground.check_inside(np.concatenate([inside, [[1e5, 1e5]], [[2e5, 2e5]]])) == 3


def test_places_on_lanes_and_across_the_road(town: Network) -> None:
    ground = Ground(town)
    # Eastbound: the right lane's middle is at 195.2 m; westbound lane ma_1 is the outermost, at 204.8 m.
    assert ground.on_lane("am_1", 60.0, 1.0) == pytest.approx((60.0, 196.2))
    assert ground.on_lane("ma_1", 6.0, 1.0) == pytest.approx((140.0, 203.8))
    road = ground.roadside("am", "ma", 60.0)
    assert (road.x, road.y, road.heading) == pytest.approx((60.0, 193.6, 0.0))
    assert road.width == pytest.approx(4 * 3.2)
    assert ground.roadside("am", "", 60.0).width == pytest.approx(2 * 3.2)
    back = ground.roadside("ma", "am", 46.0)
    assert (back.x, back.y, abs(back.heading)) == pytest.approx((100.0, 206.4, math.pi))
    assert ground.at(60.0, 192.6).edge == "am"
    assert not ground.at(60.0, 192.6).on_road
    assert ground.at(60.0, 195.2).on_road
    axis = ground.crossing(":m_c0")
    assert axis.length == pytest.approx(16.0)
    assert ground.at(*axis.point(8.0)).crossing == ":m_c0"
    assert ground.first_crossing(np.array([axis.point(-1.0), axis.point(0.2)])) == ":m_c0"
    assert ground.first_crossing(np.array([axis.point(-1.0)])) == ""


def test_the_road_across_is_the_same_where_traffic_keeps_left(tmp_path: Path) -> None:
    ground = Ground(read_network(build(tmp_path, further=["--lefthand"])))
    # Eastbound: lane am_1 is the left one, its middle at 204.8 m; westbound ma_1 is the outermost, at 195.2 m.
    assert ground.on_lane("am_1", 60.0, 0.0) == pytest.approx((60.0, 204.8))
    road = ground.roadside("am", "ma", 60.0)
    assert (road.x, road.y, road.heading) == pytest.approx((60.0, 193.6, 0.0))
    assert road.width == pytest.approx(4 * 3.2)
    alone = ground.roadside("am", "", 60.0)
    assert (alone.y, alone.width) == pytest.approx((200.0, 2 * 3.2))
    back = ground.roadside("ma", "am", 46.0)
    assert (back.x, back.y, abs(back.heading)) == pytest.approx((100.0, 206.4, math.pi))
    single = ground.roadside("js", "sj", 60.0)
    assert single.width == pytest.approx(2 * 3.2)
    assert single.x == pytest.approx(300.0 - 3.2)
    assert abs(single.heading) == pytest.approx(0.5 * math.pi)


def test_the_built_in_scenarios_have_the_roads_that_their_rows_count_on(tmp_path: Path) -> None:
    arterial = Ground(read_network(prepare(load("jaywalk_arterial"), 1, tmp_path / "a").net_file))
    assert arterial.roadside("east", "west", 400.0).width == pytest.approx(13.0, abs=0.03)
    stop = Ground(read_network(prepare(load("bus_stop_occlusion"), 1, tmp_path / "b").net_file))
    # The kerbs are 1.5 m to the right of the middle of lane 1 and 8 m to its left.
    for across, on_road in ((-1.6, False), (-1.4, True), (7.9, True), (8.1, False)):
        assert stop.at(*stop.on_lane("east_1", 301.0, across)).on_road is on_road
