"""Placement on running simulations; its effect on others is in tests/cosim/conformance."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import libsumo
import numpy as np
import pytest

from cosim.conformance.stage import build, pose_of, scene, tool, wait_for
from cosim.conformance.track import Pose, Shift, Track
from cosim.errors import SimulationError
from cosim.sumo.placement import Method, Placement

pytestmark = pytest.mark.sumo

PARAMETERS = ("laneChangeModel.lcAccelLat", "laneChangeModel.lcSigma")


def traffic(edges: str, lane: int = 1, position: float = 100.0, speed: float = 8.0) -> str:
    return f"""<route id="r" edges="{edges}"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="{lane}" departPos="{position}"
                 departSpeed="{speed}"/>"""


@contextmanager
def on_the_road(net: str, vehicle: str, step: float = 0.1, sublane: bool = True) -> Iterator[Any]:
    with scene(net, vehicle, step=step, sublane=sublane) as sumo:
        wait_for(sumo, "ego")
        yield sumo


def recorded(edges: str, lane: int, step: float) -> list[Pose]:
    """Return where a native car is over time."""
    with on_the_road("junction", traffic(edges, lane), step) as sumo:
        sumo.vehicle.setSpeedMode("ego", 32)
        sumo.vehicle.setLaneChangeMode("ego", 0)
        sumo.vehicle.setSpeed("ego", 8.0)
        poses = []
        while sumo.simulation.getTime() < 18.0:
            sumo.simulationStep()
            poses.append(pose_of(sumo, "ego"))
        return poses


@pytest.mark.parametrize("step", [0.05, 0.1, 0.5, 1.0])
@pytest.mark.parametrize(("edges", "lane"), [("wx xe", 1), ("wx xs", 1), ("wx xn", 2)])
@pytest.mark.parametrize("method", list(Method))
def test_the_ego_is_where_it_was_told_to_be_at_every_step_length_and_through_a_junction(
    step: float, edges: str, lane: int, method: Method
) -> None:
    poses = recorded(edges, lane, step)
    with on_the_road("junction", traffic(edges, lane), step) as sumo:
        placement = Placement(sumo, step, method)
        placement.take_over("ego")
        for pose in poses:
            placement.drive("ego", *pose)
            sumo.simulationStep()
            found = placement.executed("ego")
            assert math.dist(found[:2], pose[:2]) < 0.003
            assert found.speed == pytest.approx(placement.asked_speed("ego"), abs=1e-6)
            assert found.lane
        assert sumo.vehicle.getRoadID("ego") == edges.split()[-1]
        assert tuple(sumo.vehicle.getRoute("ego")) == tuple(edges.split())
        if method is Method.HYBRID:
            assert placement.moves("ego") * step < 4.0


def test_a_lane_change_is_followed_on_lanes_without_a_single_move() -> None:
    with on_the_road("straight", traffic("ab bc", speed=10.0)) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, 10.0, (Shift(0.5, 3.0, 3.5),))
        for number in range(1, 60):
            placement.drive("ego", *track.at(number * 0.1))
            sumo.simulationStep()
            placement.executed("ego")
        assert sumo.vehicle.getLaneID("ego") == "ab_2"
        assert placement.moves("ego") == 0


@pytest.mark.parametrize("step", [0.1, 1.0])
def test_hard_braking_needs_no_move(step: float) -> None:
    with on_the_road("straight", traffic("ab bc", speed=14.0), step) as sumo:
        placement = Placement(sumo, step)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, begin.speed, brakes_at=2.0, deceleration=8.0)
        for number in range(1, round(6.0 / step)):
            pose = track.at(number * step)
            placement.drive("ego", *pose)
            sumo.simulationStep()
            assert math.dist(placement.executed("ego")[:2], pose[:2]) < 1e-6
        assert placement.moves("ego") == 0


def test_an_ego_that_stops_stays_stopped_and_drives_off_again() -> None:
    with on_the_road("straight", traffic("ab bc", speed=10.0)) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, 10.0, brakes_at=1.0, deceleration=5.0)
        for number in range(1, 80):
            pose = track.at(number * 0.1)
            placement.drive("ego", *pose)
            sumo.simulationStep()
            assert math.dist(placement.executed("ego")[:2], pose[:2]) < 0.003
        assert sumo.vehicle.getSpeed("ego") == pytest.approx(0.0, abs=1e-9)
        standing = pose_of(sumo, "ego")
        for number in range(1, 30):
            time = number * 0.1
            placement.drive("ego", standing.x + time * time, standing.y, 0.0, 2.0 * time)
            sumo.simulationStep()
            found = placement.executed("ego")
        assert found.x == pytest.approx(standing.x + 2.9**2, abs=0.003)


@pytest.mark.parametrize("method", list(Method))
def test_a_released_vehicle_is_as_it_was_and_sumo_drives_it(method: Method) -> None:
    with on_the_road("straight", traffic("ab bc", speed=10.0)) as sumo:
        vehicle = sumo.vehicle

        def settings() -> list[object]:
            found: list[object] = [vehicle.getParameter("ego", key) for key in PARAMETERS]
            return [*found, vehicle.getMaxSpeedLat("ego"), vehicle.getSpeedMode("ego"), modes()]

        def modes() -> int:
            return int(vehicle.getLaneChangeMode("ego"))

        before = settings()
        placement = Placement(sumo, 0.1, method)
        placement.take_over("ego")
        assert settings() != before
        begin = pose_of(sumo, "ego")
        for number in range(1, 20):
            placement.drive("ego", begin.x + number, begin.y, 0.0, 10.0)
            sumo.simulationStep()
            placement.executed("ego")
        placement.release("ego")
        assert settings() == before
        assert not placement.drives("ego")
        for _ in range(100):
            sumo.simulationStep()
        assert vehicle.getSpeed("ego") > 15.0


def test_an_excursion_to_the_oncoming_edge_keeps_the_route() -> None:
    with on_the_road("narrow", traffic("ab bc", lane=2, position=1200.0, speed=10.0)) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, 10.0, (Shift(1.0, 2.0, 4.0), Shift(5.0, 2.0, -4.0)))
        furthest = 0.0
        for number in range(1, 100):
            placement.drive("ego", *track.at(number * 0.1))
            sumo.simulationStep()
            placement.executed("ego")
            furthest = max(furthest, placement.strayed("ego"))
            assert tuple(sumo.vehicle.getRoute("ego")) == ("ab", "bc")
            assert sumo.vehicle.getLaneID("ego") == "ab_2"
        # Further out SUMO would have it on no lane, or on the oncoming one.
        assert 1.0 < furthest < 2.0
        assert placement.strayed("ego") == 0.0


@pytest.mark.parametrize("position", [50.0, 150.0])
def test_a_route_that_somebody_else_changed_is_set_again(position: float) -> None:
    with on_the_road("junction", traffic("wx xe", lane=1, position=position, speed=10.0)) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        sumo.vehicle.setRoute("ego", ["wx", "xs"])
        for number in range(1, 60):
            placement.drive("ego", begin.x + number, begin.y, 0.0, 10.0)
            sumo.simulationStep()
            placement.executed("ego")
            assert tuple(sumo.vehicle.getRoute("ego")) == ("wx", "xe")
            assert placement.astray("ego") is (number == 1)
        assert placement.routes_restored("ego") == 1


def test_an_ego_that_cannot_follow_its_bend_stays_on_its_way() -> None:
    # It goes straight on where its way turns right: SUMO would take it for one that crosses the junction.
    with on_the_road("junction", traffic("wx xs", lane=1, position=170.0, speed=8.0)) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        furthest = 0.0
        for number in range(1, 100):
            placement.drive("ego", begin.x + 0.8 * number, begin.y, 0.0, 8.0)
            sumo.simulationStep()
            placement.executed("ego")
            furthest = max(furthest, placement.strayed("ego"))
            assert sumo.vehicle.getRoute("ego")[-1] == "xs"
            assert sumo.vehicle.getLaneID("ego")
        assert furthest > 10.0


def test_hybrid_without_the_sublane_model_is_refused() -> None:
    with (
        on_the_road("straight", traffic("ab bc"), sublane=False) as sumo,
        pytest.raises(SimulationError, match="lateral-resolution"),
    ):
        Placement(sumo, 0.1)


def test_driving_a_vehicle_that_was_not_taken_over_says_which_ones_were() -> None:
    with on_the_road("straight", traffic("ab bc")) as sumo:
        placement = Placement(sumo, 0.1)
        with pytest.raises(SimulationError, match="none"):
            placement.drive("ego", 0.0, 0.0, 0.0, 0.0)
        placement.take_over("ego")
        placement.forget("ego")
        with pytest.raises(SimulationError, match="not driven"):
            placement.executed("ego")


@pytest.mark.long
def test_a_traci_connection_does_what_libsumo_does(tmp_path: Path) -> None:
    import traci  # the window's way in; here without a window

    net = build("straight", tmp_path)
    routes = tmp_path / "ego.rou.xml"
    types = '<vType id="ego" length="4.5" width="1.8" sigma="0"/>'
    routes.write_text(f"<routes>{types}{traffic('ab bc', position=1460.0, speed=10.0)}</routes>")
    options = ["-n", str(net), "-r", str(routes), "--step-length", "0.1", "--lateral-resolution", "0.4"]
    traci.start([tool("sumo"), *options, "--no-step-log", "true"], label="placement")
    try:
        sumo = traci.getConnection("placement")
        wait_for(sumo, "ego")
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, 10.0, (Shift(0.5, 2.0, 3.5),))
        for number in range(1, 60):
            pose = track.at(number * 0.1)
            placement.drive("ego", *pose)
            sumo.simulationStep()
            assert math.dist(placement.executed("ego")[:2], pose[:2]) < 0.003
        assert sumo.vehicle.getLaneID("ego") == "bc_2"
        placement.release("ego")
    finally:
        traci.close()


def test_importing_placement_loads_no_sumo() -> None:
    program = "import sys, cosim.sumo.placement; sys.exit('libsumo' in sys.modules or 'traci' in sys.modules)"
    root = Path(__file__).resolve().parents[3]
    assert subprocess.run([sys.executable, "-c", program], cwd=root, check=False).returncode == 0


def test_an_ego_at_the_end_of_its_route_gets_no_longer_one() -> None:
    # A stop of the demand on its first edge would end the simulation: it is not on the longer route.
    demand = """<vehicle id="ego" type="ego" depart="0" departLane="1" departPos="100" departSpeed="10">
        <route edges="wx"/><stop lane="wx_1" endPos="120" duration="5"/></vehicle>"""
    with on_the_road("junction", demand) as sumo:
        placement = Placement(sumo, 0.1)
        placement.take_over("ego")
        begin = pose_of(sumo, "ego")
        sumo.vehicle.replaceStop("ego", 0, "")
        for number in range(1, 110):
            placement.drive("ego", begin.x + number, begin.y, 0.0, 10.0)
            sumo.simulationStep()
            placement.executed("ego")
            assert tuple(sumo.vehicle.getRoute("ego")) == ("wx",)
        assert placement.strayed("ego") > 5.0


@contextmanager
def in_a_grid(folder: Path, vehicle: str, *options: str) -> Iterator[tuple[Placement, Pose]]:
    """Drive the vehicle in a net of ``netgenerate``, three junctions by three; give also where it begins."""
    net, routes = folder / "grid.net.xml", folder / "ego.rou.xml"
    grid = ("--grid", "--grid.number=3", *options)
    subprocess.run([tool("netgenerate"), *grid, "-o", net], check=True, capture_output=True)
    routes.write_text(f'<routes><vType id="ego" length="4.5" width="1.8" sigma="0"/>{vehicle}</routes>')
    settings = ["--step-length", "0.1", "--lateral-resolution", "0.4", "--no-step-log", "true"]
    libsumo.start(["sumo", "-n", str(net), "-r", str(routes), *settings])
    try:
        wait_for(libsumo, "ego")
        placement = Placement(libsumo, 0.1)
        placement.take_over("ego")
        yield placement, pose_of(libsumo, "ego")
    finally:
        libsumo.close()


def test_a_route_that_comes_along_a_road_again_is_not_driven_once_more(tmp_path: Path) -> None:
    """Wide of its bend the ego is on the way straight on that it took before: SUMO would have it there again."""
    before, ahead = ("A1B1", "B1C1", "C1C0", "C0B0", "B0A0", "A0A1"), ("A1B1", "B1B0", "B0C0")
    vehicle = f"""<vehicle id="ego" type="ego" depart="0" departEdge="{len(before)}" departPos="80"
        departSpeed="4"><route edges="{" ".join((*before, *ahead))}"/></vehicle>"""
    with in_a_grid(tmp_path, vehicle) as (placement, begin):
        for number in range(1, 80):
            placement.drive("ego", begin.x + 0.3 * number, begin.y, 0.0, 3.0)
            libsumo.simulationStep()
            placement.executed("ego")
            assert not placement.astray("ego")
            assert tuple(libsumo.vehicle.getRoute("ego"))[-3:] == ahead
        assert placement.moves("ego") > 20


def test_between_two_lanes_an_ego_that_sumo_has_in_the_junction_again_is_on_its_way(tmp_path: Path) -> None:
    """Out of its bend the ego comes between two lanes; it depends on millimetres which of them is nearer."""
    vehicle = """<vehicle id="ego" type="ego" depart="0" departLane="1" departPos="last">
        <route edges="B2B1 B1C1"/></vehicle>"""
    with in_a_grid(tmp_path, vehicle, "--default.lanenumber=2") as (placement, begin):
        lanes = [libsumo.lane.getShape(f"B1C1_{index}")[0] for index in (0, 1)]
        lane_begin, between = lanes[0][0], 0.5 * (lanes[0][1] + lanes[1][1])
        turn = [
            (begin.x + share * (lane_begin - 0.6 - begin.x), begin.y + share * (between - begin.y))
            for share in np.linspace(0.0, 1.0, 60)
        ]
        wave = [(lane_begin - 0.6 + 0.02 * number, between + 0.02 * (-1) ** number) for number in range(60)]
        seen = []
        for x, y in (*turn, *wave):
            placement.drive("ego", x, y, 0.2, 2.0)
            libsumo.simulationStep()
            seen.append(placement.executed("ego").lane)
            assert not placement.astray("ego")
        there = [lane.startswith("B1C1") for lane in seen]
        assert [True, False] in [there[place : place + 2] for place in range(len(there))]
        assert placement.routes_restored("ego") == 0
