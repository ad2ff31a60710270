"""Reading networks."""

import subprocess
from pathlib import Path

import libsumo
import pytest

from controllers.interface import CrossingKind
from cosim.errors import InputError
from cosim.sumo.network import TURNAROUND, Network
from cosim.sumo.network_file import read_network
from sumo_scenarios.sumo_installation import netconvert

from . import built

ROAD = (
    '<net><edge id="e"><lane id="e_0" index="0" length="{length}" speed="1" shape="{shape}"/></edge>'
    '<connection from="e" to="e" fromLane="{link}" toLane="0"/></net>'
)


def test_crossings_know_who_has_to_wait(town: Network, unmarked_file: Path) -> None:
    kinds = {name: crossing.kind for name, crossing in town.crossings.items()}
    assert kinds[":m_c0"] is CrossingKind.ZEBRA
    assert kinds[":j_c0"] is CrossingKind.SIGNAL
    assert read_network(unmarked_file).crossings[":m_c0"].kind is CrossingKind.UNMARKED


def test_signal_crossings_know_their_link(town: Network) -> None:
    crossing = town.crossings[":j_c3"]
    assert crossing.signal == "j"
    assert len(crossing.signal_indices) == 1
    assert crossing.edges == {"jm", "mj"}
    assert crossing.width == 4.0


def test_sidewalks_are_not_for_cars(town: Network) -> None:
    assert town.allowed_lanes("am", "passenger") == [1, 2]
    assert town.allowed_lanes("am", "pedestrian") == [0]


def test_ways_through_a_junction_go_over_all_internal_lanes(town: Network) -> None:
    (left_turn,) = town.follow("mj_3", "jn", "passenger")
    assert len(left_turn.via) == 2
    assert left_turn.direction == "l"
    assert town.through[left_turn.via[0]] is left_turn


def test_a_left_turn_yields_to_oncoming_traffic_and_not_the_other_way_round(town: Network) -> None:
    (left_turn,) = town.follow("mj_3", "jn", "passenger")
    (oncoming,) = town.follow("bj_1", "jm", "passenger")
    assert (oncoming, True) in town.foes(left_turn)
    assert (left_turn, False) in town.foes(oncoming)


def test_in_an_unregulated_junction_everybody_whose_way_meets_is_yielded_to(tmp_path: Path) -> None:
    network = read_network(built.grid(tmp_path, "unregulated"))
    (own,) = network.follow("B0B1_0", "B1B2", "passenger")
    foes = network.foes(own)
    assert all(yields for _, yields in foes)
    assert {foe.source for foe, _ in foes} == {"A1B1_0", "B2B1_0", "C1B1_0"}


@pytest.mark.parametrize(
    ("junctions", "kind", "waited"),
    [("unregulated", CrossingKind.ZEBRA, False), ("priority", CrossingKind.UNMARKED, True)],
)
def test_pedestrians_wait_for_a_stream_of_cars_unless_nothing_is_regulated(
    tmp_path: Path, junctions: str, kind: CrossingKind, waited: bool
) -> None:
    walks = ["--sidewalks.guess", "--crossings.guess", "--walkingareas"]
    net, demand = built.grid(tmp_path, junctions, *walks), tmp_path / "demand.rou.xml"
    demand.write_text(
        """<routes>
            <flow id="cars" from="A1B1" to="B1C1" begin="0" end="60" period="1.6" departSpeed="max"/>
            <person id="one" depart="20" departPos="10"><walk edges="B1B0 B1A1"/></person>
        </routes>"""
    )
    crossings = read_network(net).crossings.values()
    (crossing,) = (one for one in crossings if one.edges == {"A1B1", "B1A1"} and ":B1" in one.name)
    assert crossing.kind is kind
    libsumo.start(["sumo", "-n", str(net), "-r", str(demand), "--no-step-log", "--end", "60"])
    try:
        on_it = False
        while libsumo.simulation.getTime() < 60.0:
            libsumo.simulationStep()
            there = "one" in libsumo.person.getIDList()
            on_it |= there and libsumo.person.getRoadID("one") == crossing.name
    finally:
        libsumo.close()
    assert on_it is not waited


def test_a_turnaround_is_one_whichever_side_traffic_keeps_to(tmp_path: Path) -> None:
    net = tmp_path / "net.xml"
    netgenerate = netconvert().with_name("netgenerate")
    for side in ([], ["--lefthand"]):
        options = ["--grid", "--grid.number=2", "--grid.attach-length=50", *side]
        subprocess.run([netgenerate, *options, "-o", net], check=True, capture_output=True)
        (at_the_end,) = read_network(net).connections["A0bottom0_0"]
        assert (at_the_end.target, at_the_end.direction) == ("bottom0A0_0", TURNAROUND)


@pytest.mark.parametrize(
    ("kind", "with_a_sign", "in_order"),
    [
        ("allway_stop", 12, True),
        ("priority_stop", 6, False),
        ("priority", 0, False),
        ("traffic_light", 0, False),
    ],
)
def test_stop_signs_are_where_the_network_has_them(
    tmp_path: Path, kind: str, with_a_sign: int, in_order: bool
) -> None:
    network = read_network(built.grid(tmp_path, kind))
    into = ("A1B1", "B0B1", "C1B1", "B2B1")
    onward = [one for lane, ways in network.connections.items() if lane[:4] in into for one in ways]
    signs = [one for one in onward if one.stop_sign]
    assert len(signs) == with_a_sign
    assert all(one.in_order is in_order for one in signs)


@pytest.mark.parametrize(
    ("kind", "turns"),
    [
        ("zipper", True),
        ("unregulated", True),
        ("allway_stop", True),
        ("priority", False),
        ("traffic_light", False),
    ],
)
def test_ways_that_cross_take_turns_where_both_have_to_yield_and_no_light_tells_who_drives(
    tmp_path: Path, kind: str, turns: bool
) -> None:
    network = read_network(built.grid(tmp_path, kind))
    (north,) = network.follow("B0B1_0", "B1B2", "passenger")
    (east,) = network.follow("A1B1_0", "B1C1", "passenger")
    assert network.take_turns(north, east) is network.take_turns(east, north) is turns


def test_the_measured_intersection_is_read(braunschweig: Network) -> None:
    assert len(braunschweig.crossings) == 8
    assert {crossing.kind for crossing in braunschweig.crossings.values()} == {CrossingKind.SIGNAL}
    assert braunschweig.allowed_lanes("-2", "passenger") == [3, 4, 5, 6]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("<net><edge", "is not a SUMO network"),
        ("<net/>", "has no edges"),
        ('<net><edge id="e"><lane id="e_0"/></edge></net>', "is not a complete SUMO network"),
        # Found by make fuzz.
        ('<net><edge id="w" function="walkingarea"/></net>', "'w' has no lanes"),
        (ROAD.format(length="1", shape="", link=0), "no points of x and y"),
        (ROAD.format(length="1", shape="0,0 nan,1", link=0), "'nan' is not finite"),
        (ROAD.format(length="inf", shape="0,0 1,1", link=0), "'inf' is not finite"),
        (ROAD.format(length="1", shape="0,0 1,1", link=3), "lane 3 of 'e', which has 1"),
        (ROAD.format(length="1", shape="0,0 1,1", link=-1), "lane -1 of 'e', which has 1"),
        (
            '<net><edge id=":c" function="crossing"><lane id="x" index="0" length="1" speed="1" shape="0,0 1,1"/>'
            "</edge></net>",
            "KeyError",
        ),
    ],
)
def test_a_broken_file_is_told_in_one_line(tmp_path: Path, content: str, said: str) -> None:
    path = tmp_path / "broken.net.xml"
    path.write_text(content)
    with pytest.raises(InputError, match=said) as caught:
        read_network(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_told_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.net\.xml"):
        read_network(tmp_path / "nowhere.net.xml")


def test_a_crossing_that_ends_on_an_island_has_a_refuge(town: Network, tmp_path: Path) -> None:
    assert not any(crossing.refuge for crossing in town.crossings.values())
    area = '<edge id="{0}" function="walkingarea"><lane id="{0}_0" index="0" length="1" speed="1" shape="0,0 1,0 1,1"/></edge>'
    crossing = '<edge id="{0}" function="crossing" crossingEdges="e"><lane id="{0}_0" index="0" length="3" speed="1" shape="0,0 0,3"/></edge>'
    road = '<edge id="e"><lane id="e_0" index="0" length="9" speed="1" shape="0,0 9,0"/></edge>'
    ways = (
        (":w0", ":c0"),
        (":c0", ":w1"),
        (":w1", ":c1"),
        (":c1", ":w2"),
        ("e", ":w0"),
        (":w2", "e"),
        (":w2", ":c2"),
    )
    links = "".join(f'<connection from="{a}" to="{b}" fromLane="0" toLane="0"/>' for a, b in ways)
    edges = [area.format(f":w{n}") for n in range(3)] + [crossing.format(f":c{n}") for n in range(3)]
    path = tmp_path / "island.net.xml"
    path.write_text(f"<net>{road}{''.join(edges)}{links}</net>")
    found = read_network(path)
    assert {name: one.refuge for name, one in found.crossings.items()} == {
        ":c0": True,
        ":c1": True,
        ":c2": False,
    }
    assert not found.geographic
