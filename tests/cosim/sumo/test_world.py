"""SUMO as a world: whole runs of a few seconds."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import libsumo
import numpy as np
import pytest

from controllers.interface import HAND_BACK, Command, CrossingKind, Perception, SignalState
from cosim.errors import InputError, SimulationError
from cosim.step.world import Snapshot
from cosim.sumo.world import SumoWorld
from sumo_scenarios.library import load, prepare
from sumo_scenarios.model import Egos

from .conftest import OpenWorld, keep_lane

pytestmark = pytest.mark.sumo

STRAIGHT = Egos(routes=(("am", "mj", "jb"),), count=1)
LEFT = Egos(routes=(("am", "mj", "jn"),), count=1)


def drive(
    world: SumoWorld,
    driver: Callable[[Perception], Command] = keep_lane,
    look: Callable[[Perception], None] = lambda perception: None,
) -> list[Snapshot]:
    """Run to the end and return every snapshot."""
    snapshots = []
    while (perceptions := world.sense()) is not None:
        for perception in perceptions:
            look(perception)
            world.act(perception.ego.name, driver(perception))
        world.advance()
        snapshots.append(world.snapshot())
    return snapshots


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

    def look(perception: Perception) -> None:
        ego = perception.ego
        (point,) = world.to_world(ego.name, np.zeros(1), np.array([ego.across]))
        assert point == pytest.approx([ego.x, ego.y], abs=1e-6)
        assert perception.road.limit_along[0] <= 0.0
        assert perception.road.lane(perception.road.reference) is not None

    drive(world, look=look)


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

    snapshots = drive(open_world("", egos, duration_s=40.0), look=look)
    assert max(len(snapshot.egos) for snapshot in snapshots) == 3
    assert ("ego_1", "ego_0") in seen
    assert ("ego_2", "ego_1") in seen
    assert not any("ego_0" in snapshot.vehicles.names for snapshot in snapshots)


DEMAND = (
    '<vType id="van" vClass="delivery" length="6.5" width="2.1"/>'
    '<flow id="f" type="car" begin="0" end="60" period="3" from="am" to="jb" departSpeed="8"/>'
    '<vehicle id="v" type="van" depart="5" departSpeed="8"><route edges="am mj jb"/></vehicle>'
)
FLOW = '<flow id="f" type="car" begin="0" end="60" period="3" from="am" to="jb" departSpeed="8"/>'


def test_a_share_takes_the_same_cars_whatever_they_do(open_world: OpenWorld) -> None:
    def names(wish: float) -> set[str]:
        world = open_world(FLOW, Egos(share=0.4), duration_s=40.0)
        return {
            ego.name
            for snapshot in drive(world, lambda p: keep_lane(p, wish=wish))
            for ego in snapshot.egos
            if snapshot.time < 15.0
        }

    fast, slow = names(10.0), names(9.0)
    assert fast == slow
    assert 0 < len(fast) < 5


def test_a_vehicle_of_the_demand_keeps_its_type_and_size(open_world: OpenWorld) -> None:
    demand = FLOW.replace("/>", "/>") + DEMAND[: DEMAND.index("<flow")] + DEMAND[DEMAND.index("<vehicle") :]
    snapshots = drive(open_world(demand, Egos(vehicles=("v",)), duration_s=20.0))
    bodies = {ego.body.length for snapshot in snapshots for ego in snapshot.egos}
    assert bodies == {6.5}
    assert {ego.name for snapshot in snapshots for ego in snapshot.egos} == {"v"}


@pytest.mark.parametrize(
    ("kind", "limit"),
    [('vClass="bicycle"', 20 / 3.6), ('vClass="passenger" maxSpeed="7"', 7.0), ('vClass="passenger"', 13.89)],
)
def test_an_ego_is_told_no_higher_limit_than_its_type_drives(
    open_world: OpenWorld, kind: str, limit: float
) -> None:
    demand = (
        f'<vType id="slow" {kind} speedDev="0" speedFactor="1.1"/>'
        '<vehicle id="v" type="slow" depart="0" departPos="20"><route edges="am mj"/></vehicle>'
    )
    seen: list[float] = []
    world = open_world(demand, Egos(vehicles=("v",)), duration_s=3.0)
    snapshots = drive(world, look=lambda perception: seen.append(float(perception.road.limit.max())))
    assert seen == pytest.approx([limit] * len(seen))
    assert snapshots[-1].egos[0].speed_limit == pytest.approx(limit)


def test_a_vehicle_that_never_comes_is_told_with_those_that_did(open_world: OpenWorld) -> None:
    with pytest.raises(SimulationError, match=r'vehicle "ghost" did not depart.*"f\.0"'):
        drive(open_world(FLOW, Egos(vehicles=("ghost",)), duration_s=5.0))


def test_a_demand_without_cars_has_no_share(open_world: OpenWorld) -> None:
    with pytest.raises(SimulationError, match="0 passenger cars departed"):
        drive(open_world("", Egos(share=0.5), duration_s=5.0))


def test_an_ego_that_finds_no_place_is_told(open_world: OpenWorld) -> None:
    standing = "".join(
        f'<vehicle id="s{lane}" type="car" depart="0" departLane="{lane}" departPos="7">'
        f'<route edges="am mj"/><stop lane="am_{lane}" endPos="9" duration="500"/></vehicle>'
        for lane in (1, 2)
    )
    world = open_world(standing, STRAIGHT, warmup_s=3.0, duration_s=100.0)
    with pytest.raises(SimulationError, match='ego "ego_0" could not be inserted on edge "am" for 60 s'):
        drive(world)


def test_an_unknown_vehicle_type_is_refused_with_those_there_are(open_world: OpenWorld) -> None:
    egos = Egos(routes=(("am", "mj"),), count=1, vehicle_type="lorry")
    with pytest.raises(InputError, match=r'no vehicle type "lorry".*car'):
        open_world("", egos)


def test_an_ego_may_not_have_the_name_of_a_vehicle(open_world: OpenWorld) -> None:
    demand = '<vehicle id="ego_0" type="car" depart="5"><route edges="am mj"/></vehicle>'
    with pytest.raises(InputError, match='already has a vehicle "ego_0"'):
        open_world(demand, STRAIGHT)


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


def test_riders_are_no_pedestrians_and_stops_of_an_ego_are_dropped(open_world: OpenWorld) -> None:
    demand = (
        '<vType id="coach" vClass="bus" length="10"/>'
        '<vehicle id="bus" type="coach" depart="0" departPos="20" departLane="1" departSpeed="5">'
        '<route edges="am mj jb"/><stop lane="am_1" endPos="60" duration="20"/></vehicle>'
        '<person id="rider" depart="triggered"><ride from="am" to="jb" lines="bus"/></person>'
    )
    world = open_world(demand, Egos(vehicles=("bus",)), duration_s=30.0)
    snapshots = drive(world)
    assert all(snapshot.persons.names == () for snapshot in snapshots)
    moving = [snapshot.egos[0].speed for snapshot in snapshots[50:] if snapshot.egos]
    assert min(moving) > 3.0


def test_handing_back_lets_sumo_drive_and_taking_over_again_goes_on_from_there(
    open_world: OpenWorld,
) -> None:
    def driver(perception: Perception) -> Command:
        return HAND_BACK if 5.0 < perception.ego.time < 12.0 else keep_lane(perception, wish=5.0)

    snapshots = drive(open_world("", STRAIGHT, duration_s=60.0), driver)
    rows = [(snapshot.time, snapshot.egos[0]) for snapshot in snapshots if snapshot.egos]
    back = [(time, ego) for time, ego in rows if ego.handed_back]
    assert 60 <= len(back) <= 72
    # SUMO's own driver accelerates to the limit; ours goes back to the wished 5 m/s.
    assert back[-1][1].speed > 10.0
    assert rows[-1][1].speed == pytest.approx(5.0, abs=0.5)
    places = np.array([(ego.x, ego.y) for _, ego in rows])
    assert np.hypot(*np.diff(places, axis=0).T).max() < 1.6
    assert not any(ego.intervention for _, ego in rows)


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
