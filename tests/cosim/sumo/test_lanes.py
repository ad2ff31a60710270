"""Points seen from lanes."""

from __future__ import annotations

import math
import subprocess
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import libsumo
import pytest
import sumo
from hypothesis import given
from hypothesis import strategies as st

from cosim.step.frames import degrees_of
from cosim.sumo.lane_shape import LaneShape
from cosim.sumo.lanes import MIDDLE, Lanes
from cosim.sumo.placement import EXACT_POSITION, OBEY_SPEED, Placement


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


@pytest.mark.parametrize("side", [0.001, 0.199])
def test_next_to_a_wedge_either_side_of_the_corner_counts(side: float) -> None:
    corner = lane((0.0, 0.0), (10.0, 0.0), (10.0 + 10.0 * math.cos(0.2), 10.0 * math.sin(0.2)))
    outside = 10.0 + math.sin(side), -math.cos(side)
    assert corner.drawn_off(corner.place(*outside), *outside) == pytest.approx(0.2, abs=0.01)
    inside = 10.0 - math.sin(side), math.cos(side)
    for point in (inside, (5.0, -1.0), (15.0, 2.0)):
        assert corner.drawn_off(corner.place(*point), *point) < 0.006


@given(st.floats(1.0, 45.0), st.floats(-2.0, 2.0))
def test_a_place_leads_back_to_its_point(along: float, across: float) -> None:
    place = BEND.place(*BEND.point(along, across))
    assert (place.along, place.across) == pytest.approx((along, across), abs=1e-9)


@pytest.mark.sumo
def test_lateral_positions_are_those_of_sumo_where_traffic_keeps_left(tmp_path: Path) -> None:
    net = str(tmp_path / "left.net.xml")
    netgenerate = str(Path(sumo.SUMO_HOME) / "bin" / "netgenerate")
    options = ["--grid", "--grid.number=2", "--grid.length=200", "-L", "3", "--lefthand", "-o", net]
    subprocess.run([netgenerate, *options], check=True, capture_output=True)
    libsumo.start(["sumo", "-n", net, "--lateral-resolution", "0.4", "--step-length", "0.1"])
    try:
        libsumo.route.add("r", ["A0A1"])
        libsumo.vehicle.add("ego", "r", departLane="1", departPos="20", departSpeed="10")
        libsumo.simulationStep()
        placement = Placement(libsumo, 0.1)
        placement.take_over("ego")
        x, y = libsumo.vehicle.getPosition("ego")
        for number in range(1, 121):
            # A lane to the right, back, and a lane to the left: lanes are counted the other way round.
            aside = 3.2 * math.sin(number / 120 * 2.0 * math.pi)
            placement.drive("ego", x + aside, y + number, 0.5 * math.pi, 10.0)
            libsumo.simulationStep()
            found = placement.executed("ego")
            assert math.dist((found.x, found.y), (x + aside, y + number)) < 0.02
        assert placement.moves("ego") < 10
    finally:
        libsumo.close()


class _Junction:
    """Two lanes of one edge inside a junction that go on in two others, as SUMO tells of them."""

    LINKS: ClassVar[dict[str, list[tuple[str, str]]]] = {
        "in_0": [("out_0", ":j_1_0")],
        "in_1": [("out_1", ":j_1_1"), ("side_0", ":j_9_0")],
        ":j_1_0": [("out_0", ":j_2_0")],
        ":j_1_1": [("out_1", ":j_3_0")],
        ":j_2_0": [("out_0", "")],
        ":j_3_0": [("out_1", "")],
        ":j_9_0": [("side_0", "")],
    }

    def __init__(self) -> None:
        self.lane = self.edge = self

    def getLinks(self, lane: str) -> list[tuple[str, bool, bool, bool, str]]:
        return [(target, True, True, False, via) for target, via in self.LINKS[lane]]

    def getLaneNumber(self, edge: str) -> int:
        return 2


def test_the_edges_inside_a_junction_are_those_of_all_lanes() -> None:
    lanes = Lanes(_Junction())
    assert lanes.inside("in", "out") == {":j_1", ":j_2", ":j_3"}
    assert lanes.on_way(":j_3", ("in", "out"))
    assert not lanes.on_way(":j_9", ("in", "out"))
    assert lanes.on_way("out", ("in", "out"))


def test_a_lane_that_goes_up_and_down_is_counted_piece_by_piece() -> None:
    # The second half climbs as far as it goes: it counts more than it is long from above.
    points, length = ((0.0, 0.0), (50.0, 0.0), (100.0, 0.0)), 50.0 + 50.0 * math.sqrt(2.0)
    hill = replace(lane(*points, length=length), positions=(0.0, 50.0, length))
    assert hill.position(20.0) == pytest.approx(20.0)
    assert hill.position(60.0) == pytest.approx(50.0 + 10.0 * math.sqrt(2.0))
    assert hill.position(110.0) == pytest.approx(length + 10.0 * math.sqrt(2.0))
    assert hill.position(-1.0) == pytest.approx(-1.0)


@pytest.mark.sumo
def test_an_ego_is_driven_exactly_over_hills(tmp_path: Path) -> None:
    (tmp_path / "n.nod.xml").write_text(
        '<nodes><node id="a" x="0" y="0" z="0"/><node id="b" x="300" y="0" z="0"/></nodes>'
    )
    heights = " ".join(f"{x},0,{4.0 * math.sin(x / 15.0):.2f}" for x in range(0, 301, 20))
    (tmp_path / "e.edg.xml").write_text(
        f'<edges><edge id="ab" from="a" to="b" numLanes="2" speed="13.9" shape="{heights}"/></edges>'
    )
    netconvert = str(Path(sumo.SUMO_HOME) / "bin" / "netconvert")
    command = [netconvert, "-n", "n.nod.xml", "-e", "e.edg.xml", "-o", "hills.net.xml"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    net = str(tmp_path / "hills.net.xml")
    libsumo.start(["sumo", "-n", net, "--lateral-resolution", "0.4", "--step-length", "0.1"])
    try:
        libsumo.route.add("r", ["ab"])
        libsumo.vehicle.add("ego", "r", departLane="1", departPos="20", departSpeed="10")
        libsumo.simulationStep()
        shape = Lanes(libsumo).shape("ab_1")
        assert shape.length > shape.shape_length + 1.0
        placement = Placement(libsumo, 0.1)
        placement.take_over("ego")
        x, y = libsumo.vehicle.getPosition("ego")
        off = 0.0
        for number in range(1, 240):
            placement.drive("ego", x + number, y, 0.0, 10.0)
            libsumo.simulationStep()
            executed = placement.executed("ego")
            off = max(off, math.hypot(executed.x - x - number, executed.y - y))
        assert off < 0.005
        assert placement.moves("ego") == 0
    finally:
        libsumo.close()


@pytest.mark.sumo
def test_lanes_of_the_route_decide_in_junctions_that_it_passes_once(tmp_path: Path) -> None:
    net = str(tmp_path / "grid.net.xml")
    netgenerate = str(Path(sumo.SUMO_HOME) / "bin" / "netgenerate")
    subprocess.run([netgenerate, "--grid", "--grid.number=3", "-o", net], check=True, capture_output=True)
    libsumo.start(["sumo", "-n", net])
    try:
        lanes = Lanes(libsumo)
        once, twice = ("A1B1", "B1C1", "C1C2"), ("A1B1", "B1C1", "C1C2", "C2B2", "B2B1", "B1B0")
        (name,) = (link.via for link in lanes.links("A1B1_0") if link.lane == "B1C1_0")
        inside, road = lanes.shape(name), lanes.shape("B1C1_0")
        beside = inside.point(0.5 * inside.shape_length, 2.0)
        assert lanes.found_on_route(inside, (), once, 1.8, *beside)
        # On the way back from the north it passes the place beside its way.
        assert not lanes.found_on_route(inside, (), twice, 1.8, *beside)
        # It came by from the north before.
        back = ("C2B2", "B2B1", "B1B0", "B0A0", "A0A1")
        assert not lanes.found_on_route(inside, back, once, 1.8, *beside)
        assert lanes.found_on_route(inside, ("A2A1",), once, 1.8, *beside)
        assert not lanes.found_on_route(inside, (), once[-1:], 1.8, *inside.point(0.0, 3.0))
        assert not lanes.found_on_route(inside, (), once, 1.8, *inside.point(0.5 * inside.shape_length, 3.0))
        assert lanes.found_on_route(road, (), once, 1.8, *road.point(-0.5, 1.0))
        assert not lanes.found_on_route(road, (), once, 1.8, *road.point(20.0, 1.0))
        # A round trip ends there.
        assert not lanes.found_on_route(road, (), twice[:-1], 1.8, *road.point(-0.5, 1.0))
    finally:
        libsumo.close()


@pytest.mark.sumo
@pytest.mark.parametrize("along", [-0.06, -0.03, -0.01])
def test_at_the_beginning_of_its_lane_sumo_does_not_take_the_ego_for_one_straight_on(
    along: float, tmp_path: Path
) -> None:
    """Another way through the junction ends where that of the ego's turn does, and is nearer on its side."""
    net = str(tmp_path / "grid.net.xml")
    netgenerate = str(Path(sumo.SUMO_HOME) / "bin" / "netgenerate")
    options = ["--grid", "--grid.number=3", "--default.lanenumber=2"]
    subprocess.run([netgenerate, *options, "-o", net], check=True, capture_output=True)
    libsumo.start(["sumo", "-n", net, "--step-length", "0.1"])
    try:
        edges = ("C1B1", "B1B0")
        libsumo.route.add("turn", edges)
        libsumo.vehicle.add("ego", "turn", departLane="1", departPos="last")
        libsumo.simulationStep()
        lanes = Lanes(libsumo)
        lane = lanes.shape("B1B0_1")
        (inside,) = (lanes.shape(link.via) for link in lanes.links("C1B1_1") if link.lane == lane.name)
        libsumo.vehicle.setSpeedMode("ego", OBEY_SPEED)
        before = inside.point(inside.shape_length - 0.6, 0.0)
        libsumo.vehicle.moveToXY("ego", inside.edge, inside.index, *before, 180.0, EXACT_POSITION)
        libsumo.simulationStep()
        place = lane.point(along, -MIDDLE)
        x, y, heading = lanes.placeable(lane, 1.8, *place, math.radians(-100.0))
        assert math.dist((x, y), place) < 0.1
        libsumo.vehicle.moveToXY("ego", lane.edge, lane.index, x, y, degrees_of(heading), EXACT_POSITION)
        libsumo.simulationStep()
        assert libsumo.vehicle.getRoute("ego") == edges
        assert libsumo.vehicle.getLaneID("ego") == lane.name
    finally:
        libsumo.close()
