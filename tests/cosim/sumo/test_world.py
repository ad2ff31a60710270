"""SUMO as a world: whole runs of a few seconds."""

import math
from dataclasses import replace
from pathlib import Path

import libsumo
import numpy as np
import pytest

from controllers.interface import Command, CrossingKind, Perception, SignalState
from cosim.errors import InputError, SimulationError
from cosim.sumo.world import SumoWorld
from sumo_scenarios.library import load, prepare
from sumo_scenarios.model import Egos

from .conftest import STRAIGHT, OpenWorld, drive, keep_lane

pytestmark = pytest.mark.sumo

LEFT = Egos(routes=(("am", "mj", "jn"),), count=1)


@pytest.mark.long
@pytest.mark.parametrize("actuation", ["hybrid", "move"])
@pytest.mark.parametrize("step_s", [0.05, 0.1, 0.25, 1.0])
def test_an_ego_drives_its_route_to_the_end_where_the_plant_says(
    open_world: OpenWorld, step_s: float, actuation: str
) -> None:
    world = open_world("", LEFT, step_s=step_s, actuation=actuation, duration_s=150.0)
    snapshots = drive(world, lambda p: keep_lane(p, wish=4.0 if step_s > 0.5 else 10.0))
    rows = [ego for snapshot in snapshots for ego in snapshot.egos]
    assert {ego.edge for ego in rows} >= {"am", "mj", "jn"}
    assert snapshots[-1].time < 149.0
    off = [math.dist((ego.x, ego.y), (ego.executed_x, ego.executed_y)) for ego in rows]
    assert max(off) < 0.02
    assert not any(ego.intervention for ego in rows)
    assert rows[-1].route_position > 450.0
    assert snapshots[-1].teleports == 0
    assert {area.kind for area in world.map_areas()} == {"lane", "crossing", "walkingarea"}


def test_plans_are_asked_for_every_tenth_of_a_second_at_most(open_world: OpenWorld) -> None:
    times: list[float] = []
    drive(open_world("", STRAIGHT, step_s=0.05, duration_s=5.0), look=lambda p: times.append(p.ego.time))
    assert np.diff(times) == pytest.approx(0.1)


def test_the_route_frame_and_the_world_agree(open_world: OpenWorld) -> None:
    world = open_world("", LEFT, duration_s=40.0)
    across: list[float] = []

    def look(perception: Perception) -> None:
        ego = perception.ego
        across.append(ego.across)
        (point,) = world.to_world(ego.name, np.zeros(1), np.array([ego.across]))
        assert point == pytest.approx([ego.x, ego.y], abs=1e-6)
        assert perception.road.limit_along[0] <= 0.0
        assert perception.road.lane(perception.road.reference) is not None

    drive(world, look=look)
    assert len(across) > 100


def test_gaps_on_a_straight_road_are_those_of_sumo_plus_the_minimum_gap(open_world: OpenWorld) -> None:
    demand = (
        '<flow id="f" type="car" begin="0" end="60" period="2" from="am" to="jb" departLane="random"'
        ' departSpeed="8"/>'
    )
    world = open_world(demand, STRAIGHT, warmup_s=20.0, duration_s=40.0)
    compared = 0

    def look(perception: Perception) -> None:
        nonlocal compared
        name, gaps = perception.ego.name, perception.gaps
        x = perception.ego.x
        if not 50.0 < x < 130.0:
            return
        leader = libsumo.vehicle.getLeader(name, 40.0)
        if leader is not None and leader[1] + 2.5 < 35.0 and libsumo.vehicle.getLaneID(leader[0])[:2] == "am":
            assert gaps.ahead is not None
            assert gaps.ahead.name == leader[0]
            assert gaps.ahead.gap == pytest.approx(leader[1] + 2.5, abs=0.05)
            compared += 1
        for mode, found in ((0b10, gaps.left_ahead), (0b11, gaps.right_ahead), (0b00, gaps.left_behind)):
            near = libsumo.vehicle.getNeighbors(name, mode)
            if (
                len(near) == 1
                and 0.0 < near[0][1] < 30.0
                and libsumo.vehicle.getLaneID(near[0][0])[:2] == "am"
            ):
                assert found is not None
                assert found.name == near[0][0]
                # SUMO's bodies do not turn while they change lanes.
                assert found.gap == pytest.approx(near[0][1] + 2.5, abs=0.15)
                compared += 1

    drive(world, look=look)
    assert compared > 50


@pytest.mark.long
def test_pedestrians_first_wait_and_then_cross(open_world: OpenWorld) -> None:
    seen: dict[str, list[str]] = {}

    def look(perception: Perception) -> None:
        people, crossings = perception.pedestrians, perception.road.crossings
        for row, name in enumerate(people.names):
            if people.crossing[row] < 0:
                continue
            assert crossings[people.crossing[row]].name == ":m_c0"
            assert crossings[people.crossing[row]].kind is CrossingKind.ZEBRA
            assert people.on_crossing[row] != people.waiting[row]
            seen.setdefault(name, []).append("on" if people.on_crossing[row] else "before")
            if people.on_crossing[row]:
                crossing = crossings[people.crossing[row]]
                assert crossing.entry - 0.5 < people.along[row] < crossing.exit + 0.5
                assert crossing.right - 0.5 < people.across[row] < crossing.left + 0.5

    demand = (
        '<personFlow id="p" begin="0" end="40" period="3" departPos="130">'
        '<walk from="am" to="ma" arrivalPos="30"/></personFlow>'
    )
    snapshots = drive(
        open_world(demand, STRAIGHT, warmup_s=5.0, duration_s=50.0), lambda p: keep_lane(p, wish=4.0), look
    )
    both = [phases for phases in seen.values() if len(set(phases)) == 2]
    assert both
    for phases in both:
        assert phases == sorted(phases)
    assert {phase for s in snapshots for phase in s.persons.phase} == {"walking", "waiting", "crossing"}
    speeds = np.concatenate([np.hypot(s.persons.x_speed, s.persons.y_speed) for s in snapshots])
    assert 0.8 < np.median(speeds[speeds > 0.1]) < 1.7


def test_where_lights_are_switched_off_pedestrians_have_the_priority_that_sumo_gives_them(
    open_world: OpenWorld,
) -> None:
    """They step out in front of vehicles as at a zebra, and so that is what the ego is told."""

    def kinds() -> set[CrossingKind]:
        (seen,) = world.sense() or ()
        return {one.kind for one in seen.road.crossings if one.name.startswith(":j_")}

    world = open_world("", Egos(routes=(("mj", "jb"),), count=1))
    world.sense()
    world.advance()
    world.advance()
    assert kinds() == {CrossingKind.SIGNAL}
    libsumo.trafficlight.setProgram("j", "off")
    assert "O" in libsumo.trafficlight.getRedYellowGreenState("j")
    assert kinds() == {CrossingKind.ZEBRA}
    blinking = "o" * len(libsumo.trafficlight.getRedYellowGreenState("j"))
    libsumo.trafficlight.setRedYellowGreenState("j", blinking)
    assert kinds() == {CrossingKind.UNMARKED}


@pytest.mark.long
def test_signals_are_what_sumo_says(open_world: OpenWorld) -> None:
    states = set()

    def look(perception: Perception) -> None:
        for signal in perception.road.signals:
            letter = libsumo.trafficlight.getRedYellowGreenState("j")[13]
            wanted = {"r": SignalState.RED, "y": SignalState.AMBER}.get(letter, SignalState.GREEN)
            assert signal.state is wanted
            states.add(signal.state)

    egos = Egos(routes=(("mj", "jn"),), count=1)
    drive(open_world("", egos, duration_s=100.0), lambda p: keep_lane(p, wish=1.0), look)
    assert states == set(SignalState)


def test_oncoming_cars_are_foes_of_a_left_turn(open_world: OpenWorld) -> None:
    long = '<vType id="long" vClass="truck" length="15" sigma="0" speedDev="0"/>'
    demand = long + "".join(
        f'<flow id="f.{kind}" type="{kind}" begin="{begin}" end="60" period="10" from="bj" to="jm" '
        'departSpeed="max" departLane="1"/>'
        for kind, begin in (("car", 0), ("long", 5))
    )
    entries: list[float] = []
    lengths: dict[str, float] = {}

    def look(perception: Perception) -> None:
        for foe in perception.road.foes:
            kind = foe.name.split(".")[1]
            lengths[kind] = max(lengths.get(kind, 0.0), foe.foe_exit - foe.foe_entry)
            assert foe.name.startswith("f.")
            assert foe.must_yield
            assert foe.stop_line < foe.entry < foe.exit
            assert foe.waiting_place is not None
            assert foe.stop_line < foe.waiting_place
            assert foe.foe_entry < foe.foe_exit
            entries.append(foe.foe_entry)

    egos = Egos(routes=(("mj", "jn"),), count=1)
    world = open_world(demand, egos, duration_s=25.0)
    drive(world, lambda p: keep_lane(p, wish=4.0 if p.ego.x < 250.0 else 1.0), look)
    assert max(entries) > 40.0
    assert min(entries) < 0.0
    assert lengths["long"] - lengths["car"] == pytest.approx(10.0)  # 15 m against SUMO's 5 m


def test_several_egos_see_each_other(open_world: OpenWorld) -> None:
    egos = Egos(routes=(("am", "mj", "jb"),), count=3, headway_s=3.0, depart_lane="1")
    seen: set[tuple[str, str]] = set()

    def look(perception: Perception) -> None:
        if perception.gaps.ahead is not None:
            seen.add((perception.ego.name, perception.gaps.ahead.name))

    snapshots = drive(open_world("", egos, duration_s=20.0), look=look)
    assert max(len(snapshot.egos) for snapshot in snapshots) == 3
    assert ("ego_1", "ego_0") in seen
    assert ("ego_2", "ego_1") in seen
    assert not any("ego_0" in snapshot.vehicles.names for snapshot in snapshots)


def test_a_pedestrian_with_the_name_of_a_vehicle_is_told_apart(open_world: OpenWorld) -> None:
    demand = (
        '<person id="x" depart="0" departPos="60"><walk from="am" to="mj"/></person>'
        '<vehicle id="x" type="car" depart="0" departPos="80" departSpeed="5"><route edges="am mj jb"/></vehicle>'
    )
    both = []

    def look(perception: Perception) -> None:
        both.append(perception.pedestrians.names == ("x",) and perception.vehicles.names == ("x",))

    drive(open_world(demand, STRAIGHT, duration_s=6.0), look=look)
    assert sum(both) > 30


def test_a_lane_change_changes_the_reference_lane_and_its_number(open_world: OpenWorld) -> None:
    egos = Egos(routes=(("am", "mj", "jb"),), count=1, depart_lane="1")
    numbers: list[int] = []
    jumps: list[float] = []

    def driver(perception: Perception) -> Command:
        ego, road = perception.ego, perception.road
        numbers.append(road.reference)
        left = road.lane(1)
        target = left.offset if left is not None and ego.time > 3.0 else 0.0
        jumps.append(ego.across - target)
        aim = -0.9 * ego.heading_error - 0.08 * (ego.across - target)
        command = keep_lane(perception, wish=8.0)
        return Command(command.times, command.acceleration, np.array([np.clip(aim, -0.05, 0.05)]))

    snapshots = drive(open_world("", egos, duration_s=15.0), driver)
    assert numbers[0] == 0
    assert numbers[-1] == 1
    assert np.diff(numbers).min() >= 0
    # Seen from its target the ego moves smoothly, whichever lane is the reference.
    assert np.abs(np.diff(jumps[40:])).max() < 0.2
    assert snapshots[-1].egos[0].lane.endswith("_2")


def test_an_error_of_sumo_in_mid_run_says_when(open_world: OpenWorld) -> None:
    world = open_world("", STRAIGHT, duration_s=10.0)
    for _ in range(20):
        perceptions = world.sense() or ()
        for perception in perceptions:
            world.act(perception.ego.name, keep_lane(perception))
        world.advance()
    before = world.snapshot()
    libsumo.vehicle.remove("ego_0")
    with pytest.raises(SimulationError, match=r"SUMO failed while stepping from 2\.00 s.*ego_0"):
        world.advance()
    assert world.snapshot().time == before.time


def test_a_second_world_in_the_same_process_is_refused(open_world: OpenWorld, tmp_path: Path) -> None:
    open_world("", STRAIGHT)
    from cosim.sumo.connection import start

    with pytest.raises(SimulationError, match="runs a simulation already"):
        start(["-n", "any.net.xml"])


def test_closing_after_a_move_leaves_nothing_behind(open_world: OpenWorld) -> None:
    egos = Egos(routes=(("mj", "jn"),), count=1)
    for _ in range(2):
        world = open_world("", egos, duration_s=4.0, actuation="move")
        assert any(snapshot.egos for snapshot in drive(world))


def test_what_sumo_refuses_is_one_line(open_world: OpenWorld) -> None:
    with pytest.raises(InputError, match=r"SUMO cannot start: .*nowhere") as caught:
        open_world('<flow id="f" type="car" begin="0" end="9" period="3" from="nowhere" to="jb"/>', STRAIGHT)
    assert "\n" not in str(caught.value)


@pytest.mark.long
def test_a_library_scenario_runs_with_its_pedestrians(tmp_path: Path) -> None:
    scenario = load("midblock_zebra")
    scenario = replace(scenario, duration_s=scenario.warmup_s + 30.0)
    world = SumoWorld(scenario, prepare(scenario, 3, tmp_path), 3)
    kinds: set[CrossingKind] = set()
    try:
        snapshots = drive(
            world,
            lambda perception: keep_lane(perception, wish=8.0),
            lambda perception: kinds.update(crossing.kind for crossing in perception.road.crossings),
        )
    finally:
        world.close()
    assert kinds == {CrossingKind.ZEBRA}
    assert snapshots[0].time > scenario.warmup_s
    assert any(snapshot.persons.names for snapshot in snapshots)
    assert not any(ego.intervention for snapshot in snapshots for ego in snapshot.egos)
