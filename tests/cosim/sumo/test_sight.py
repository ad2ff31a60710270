"""How far egos look, on a slow network and on one whose main road is driven at 100 km/h."""

from pathlib import Path

import pytest

from controllers.interface import Perception
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.sight import Sight, sight
from sumo_scenarios.model import Egos

from . import built
from .conftest import OpenWorld, drive, keep_lane

pytestmark = pytest.mark.sumo

ENDS = {"w": (-500, 0), "e": (500, 0), "n": (0, 400), "s": (0, -400)}
FAST = 27.78
FULL_STOP = FAST**2 / (2.0 * 6.0)
"""With 6 m/s^2 [m]."""


@pytest.fixture(scope="module")
def rural(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A crossroads outside towns: who comes from south or north gives way, and people cross in the west."""
    folder = tmp_path_factory.mktemp("rural")
    nodes = "".join(f'<node id="{name}" x="{x}" y="{y}"/>' for name, (x, y) in ENDS.items())
    edges = "".join(
        f'<edge id="{one}{two}" from="{one}" to="{two}" speed="{FAST}" sidewalkWidth="2" '
        f'priority="{9 if name in "we" else 1}"/>'
        for name in ENDS
        for one, two in ((name, "c"), ("c", name))
    )
    crossing = '<crossing node="c" edges="wc cw" priority="true"/>'
    return built.network(folder, f'{nodes}<node id="c" x="0" y="0"/>', edges, crossing)


def test_in_towns_it_is_the_same_everywhere_and_farther_where_roads_are_fast(
    town: Network, rural: Path
) -> None:
    assert sight(town) == Sight(80.0, 120.0)
    far = sight(read_network(rural))
    assert far.persons == pytest.approx(0.5 * FAST + FAST**2 / 6.0)
    assert far.vehicles == pytest.approx(8.5 * FAST)


def test_a_fast_ego_is_told_of_those_it_has_to_let_pass_while_it_can_stop(
    open_world: OpenWorld, rural: Path
) -> None:
    """Who comes at 100 km/h is told of 8 s before it is there: a standing ego needs 6 s to be across."""
    flow = '<flow id="f" type="car" from="wc" to="ce" begin="0" end="60" period="3" departSpeed="max"/>'
    told: list[float] = []
    away: list[float] = []

    def look(perception: Perception) -> None:
        ego, foes = perception.ego, [foe for foe in perception.road.foes if foe.must_yield]
        away.extend(foe.foe_entry for foe in foes)
        if ego.speed > 25.0:
            told.extend(foe.stop_line - ego.body.front for foe in foes)

    egos = Egos(routes=(("sc", "cn"),), count=1)
    world = open_world(flow, egos, network=rural, warmup_s=20.0, duration_s=45.0)
    drive(world, lambda p: keep_lane(p, wish=FAST), look)
    assert max(told) > FULL_STOP + 10.0
    assert max(away) > 200.0


def test_a_fast_ego_is_told_of_people_on_the_road_while_it_can_stop_without_haste(
    open_world: OpenWorld, rural: Path
) -> None:
    waits = (
        '<person id="p" depart="0" departPos="470"><walk edges="wc" arrivalPos="480"/>'
        '<stop lane="wc_0" endPos="480" duration="60"/></person>'
    )
    seen: list[float] = []

    def look(perception: Perception) -> None:
        seen.extend((perception.pedestrians.along - perception.ego.body.front).tolist())

    egos = Egos(routes=(("wc", "ce"),), count=1)
    world = open_world(waits, egos, network=rural, duration_s=20.0)
    drive(world, lambda p: keep_lane(p, wish=FAST), look)
    assert max(seen) > 2.0 * FULL_STOP


def test_an_ego_that_turns_round_is_told_of_those_whose_way_it_swings_into(
    open_world: OpenWorld, rural: Path
) -> None:
    """SUMO draws the turn in 5 m between two lanes; a car needs so much room that it meets the main road."""
    flow = '<flow id="f" type="car" from="wc" to="ce" begin="0" end="60" period="4" departSpeed="max"/>'
    told: set[str] = set()

    def look(perception: Perception) -> None:
        for foe in perception.road.foes:
            told.add(foe.name.split(".")[0])
            assert foe.must_yield

    egos = Egos(routes=(("sc", "cs"),), count=1)
    world = open_world(flow, egos, network=rural, warmup_s=20.0, duration_s=60.0)
    (turn,) = (one for one in world._network.connections["sc_1"] if one.target == "cs_1")
    assert not any(foe.source == "wc_1" and foe.target == "ce_1" for foe, _ in world._network.foes(turn))
    drive(world, lambda p: keep_lane(p, wish=8.0), look)
    assert told == {"f"}
