"""How egos come about in SUMO, as whom, and how they are handed back: whole runs of a few seconds."""

import numpy as np
import pytest

from controllers.interface import HAND_BACK, Command, Perception
from cosim.errors import CosimError, InputError, SimulationError
from sumo_scenarios.model import Egos

from .conftest import STRAIGHT, OpenWorld, drive, keep_lane

pytestmark = pytest.mark.sumo

VAN = (
    '<vType id="van" vClass="delivery" length="6.5" width="2.1"/>'
    '<vehicle id="v" type="van" depart="5" departSpeed="8"><route edges="am mj jb"/></vehicle>'
)
TAXI = 'vClass="taxi"><param key="has.taxi.device" value="true"/>'
FLOW = '<flow id="f" type="car" begin="0" end="60" period="3" from="am" to="jb" departSpeed="8"/>'


def test_a_share_takes_the_same_cars_whatever_they_do(open_world: OpenWorld) -> None:
    def names(wish: float) -> set[str]:
        world = open_world(FLOW, Egos(share=0.4), duration_s=15.0)
        snapshots = drive(world, lambda p: keep_lane(p, wish=wish))
        return {ego.name for snapshot in snapshots for ego in snapshot.egos}

    fast, slow = names(10.0), names(9.0)
    assert fast == slow
    assert 0 < len(fast) < 5


def test_a_vehicle_of_the_demand_keeps_its_type_and_size(open_world: OpenWorld) -> None:
    snapshots = drive(open_world(FLOW + VAN, Egos(vehicles=("v",)), duration_s=20.0))
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


def test_cars_of_which_none_is_drawn_are_told_with_the_share(open_world: OpenWorld) -> None:
    car = '<vehicle id="only" type="car" depart="0"><route edges="am mj"/></vehicle>'
    with pytest.raises(SimulationError, match=r"1 passenger cars .* none of them was drawn .* 0\.001;"):
        drive(open_world(car, Egos(share=0.001), duration_s=5.0))


@pytest.mark.parametrize("depart", [0, 1])
def test_a_lane_change_model_that_hybrid_excludes_is_told_with_what_to_do(
    open_world: OpenWorld, depart: int
) -> None:
    demand = (
        '<vType id="plain" laneChangeModel="LC2013"/>'
        f'<flow id="f" type="plain" begin="{depart}" end="9" number="1"><route edges="am mj"/></flow>'
    )
    egos = Egos(vehicles=("f.0",))
    with pytest.raises(CosimError, match=r"'LC2013' is not compatible .*; choose --actuation move"):
        drive(open_world(demand, egos, duration_s=2.0))
    assert drive(open_world(demand, egos, duration_s=2.0, actuation="move"))[-1].egos


def test_a_share_is_taken_of_cars_that_only_a_calibrator_inserts(open_world: OpenWorld) -> None:
    calibrator = (
        '<vType id="van" vClass="passenger"/><calibrator id="c" lane="am_1" pos="5" period="10">'
        '<route id="r" edges="am mj jb"/>'
        '<flow begin="0" end="60" vehsPerHour="900" route="r" type="van"/></calibrator>'
    )
    world = open_world("", Egos(share=1.0), duration_s=20.0, additional=calibrator)
    egos = {ego.name for snapshot in drive(world) for ego in snapshot.egos}
    assert len(egos) >= 2


@pytest.mark.parametrize(
    ("kind", "words"),
    [('vClass="tram">', "is of class tram; an ego has to drive on a road"), (TAXI, "is a taxi")],
)
def test_a_vehicle_that_no_controller_can_drive_to_its_destination_is_refused(
    open_world: OpenWorld, kind: str, words: str
) -> None:
    vehicle = '<vehicle id="v" type="other" depart="0"><route edges="am mj"/></vehicle>'
    demand = f'<vType id="other" {kind}</vType>{vehicle}'
    with pytest.raises(InputError, match=f'vehicle "v" {words}'):
        drive(open_world(demand, Egos(vehicles=("v",)), duration_s=5.0))


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
    with pytest.raises(InputError, match=r'already has a vehicle "ego_0" in .*; give the vehicle another id'):
        open_world(demand, STRAIGHT)


@pytest.mark.parametrize("element", ["vehicle", "trip"])
def test_not_even_of_one_that_sumo_has_not_read_yet(open_world: OpenWorld, element: str) -> None:
    """SUMO reads a demand 200 s ahead; the second ego departs before that, or after the namesake."""
    way = 'from="am" to="mj"/>' if element == "trip" else '><route edges="am mj"/></vehicle>'
    demand = (
        f'<vehicle id="v" depart="0"><route edges="am mj"/></vehicle><{element} depart="230" id="ego_1" {way}'
    )
    for headway_s in (5.0, 260.0):
        egos = Egos(routes=(("am", "mj"),), count=2, headway_s=headway_s)
        with pytest.raises(InputError, match=r'vehicle "ego_1" in demand\d\.rou\.xml, the name of an ego'):
            open_world(demand, egos)
    open_world(demand, STRAIGHT, duration_s=5.0)
    open_world(f"<!-- {demand} -->", Egos(routes=(("am", "mj"),), count=2))


def test_an_ego_that_strikes_somebody_stays_whatever_the_configuration_says(open_world: OpenWorld) -> None:
    demand = (
        '<personFlow id="p" begin="0" end="40" period="1" departPos="130">'
        '<walk from="am" to="ma" arrivalPos="30"/></personFlow>'
    )
    options = '<intermodal-collision.action value="teleport"/>'
    world = open_world(demand, STRAIGHT, warmup_s=20.0, duration_s=40.0, processing=options)
    snapshots = drive(world)
    assert snapshots[-1].teleports == 0
    assert max(ego.x for one in snapshots for ego in one.egos) > 170.0


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
