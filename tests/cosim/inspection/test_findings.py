"""What is found out about networks whose defects are known, and whether the suggested commands mend them."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from controllers.interface import CrossingKind
from cosim.inspection.finding import Level
from cosim.inspection.inspection import inspect
from cosim.inspection.scaffold import write_scaffold
from cosim.inspection.walks import walks_over
from sumo_scenarios.sumo_installation import packaged_file
from tests.cosim.inspection.found import finding, missing
from tests.cosim.inspection.towns import CARS, CROSSINGS, PERSONS, WALKS, build, call_line, configure

BRAUNSCHWEIG = "tools/game/fokr_bs_demo.sumocfg"


def test_braunschweig_is_what_its_files_say() -> None:
    found = inspect(packaged_file(BRAUNSCHWEIG))
    assert found.possible
    assert {kind for kind, _ in found.counts} == {CrossingKind.SIGNAL}
    # Every arm of the intersection has two crossings, one over its way in and one over its way out.
    assert {lanes: count for (_, lanes), count in found.counts.items()} == {2: 4, 3: 1, 5: 3}
    assert {name for route in found.routes for name in route.crossings} == set(found.network.crossings)
    assert found.source.step_s == 0.05
    assert found.demand.ignored == {}
    assert found.demand.persons > 1000
    cars = found.demand.vehicles["passenger"]
    of_cars = [count for way, count in found.demand.ways.items() if way.kind == "passenger"]
    assert sum(of_cars) == pytest.approx(cars)
    # The network is one intersection with crossings on all arms: nobody gets past them.
    assert f"{cars:,.0f} of {cars:,.0f} cars" in finding(found, "ego routes").text


JUDGE = """
import json, sys
from collections import Counter
from sumo.tools import sumolib
# With lxml it does not read which edges a crossing crosses.
net = sumolib.net.readNet(sys.argv[1], withInternal=True, withPedestrianConnections=True, lxml=False)
def cars(edge): return sum(lane.allows("passenger") for lane in edge.getLanes())
def walks(edge): return any(l.allows("pedestrian") and not l.allows("passenger") for l in edge.getLanes())
crossed = Counter()
for edge in net.getEdges():
    if edge.getFunction() == "crossing":
        crossed[sum(map(cars, edge.getCrossingEdges()))] += 1
roads = net.getEdges(withInternal=False)
several = sum(cars(one) > 1 for one in roads)
print(json.dumps([sorted(crossed.items()), len(roads), several, sum(map(walks, roads))]))
"""


@pytest.mark.long
def test_sumos_own_reader_counts_the_same_in_braunschweig() -> None:
    found = inspect(packaged_file(BRAUNSCHWEIG))
    command = [sys.executable, "-c", JUDGE, str(found.source.net_file)]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    crossed, roads, several, with_sidewalk = json.loads(said)
    assert {lanes: count for (_, lanes), count in found.counts.items()} == dict(crossed)
    assert finding(found, "roads").text == (
        f"{roads} of {roads} edges are for cars; {several} have more than one lane"
    )
    assert finding(found, "sidewalks").text.startswith(f"{with_sidewalk} of {roads} edges")


def test_a_network_without_sidewalks_is_mended_by_the_suggested_command(tmp_path: Path) -> None:
    found = inspect(build(tmp_path))
    assert missing(found) == {"sidewalks", "crossings", "ego routes"}
    assert "6 of 6" in finding(found, "permissions").text
    call_line(finding(found, "sidewalks").command, tmp_path)
    mended = inspect(tmp_path / "town-crossings.net.xml")
    assert mended.possible
    assert sum(mended.counts.values()) == 3
    assert "share no lane" in finding(mended, "permissions").text


def test_a_network_with_sidewalks_and_no_crossing_is_mended_by_the_suggested_command(tmp_path: Path) -> None:
    found = inspect(build(tmp_path, *WALKS))
    assert missing(found) == {"crossings", "ego routes"}
    command = finding(found, "crossings").command
    assert "--sidewalks" not in command
    call_line(command, tmp_path)
    mended = inspect(tmp_path / "town-crossings.net.xml")
    assert mended.possible
    assert sum(mended.counts.values()) == 3


def test_crossings_are_counted_by_kind_and_lanes(tmp_path: Path) -> None:
    (tmp_path / "c.con.xml").write_text(
        '<connections><crossing node="b" edges="east_1 west_2" priority="true"/>'
        '<crossing node="b" edges="east_2 west_1"/></connections>'
    )
    found = inspect(build(tmp_path, *WALKS, "--connection-files", "c.con.xml", lanes=3))
    assert found.counts == {(CrossingKind.ZEBRA, 6): 1, (CrossingKind.UNMARKED, 6): 1}
    with_signals = inspect(build(tmp_path, *WALKS, *CROSSINGS, "--tls.set", "b", lanes=1))
    assert with_signals.counts == {(CrossingKind.SIGNAL, 2): 3}
    assert finding(with_signals, "roads").level is Level.NOTE


def test_cars_that_drive_over_a_crossing_and_people_who_walk_over_it_are_told_from_others(
    tmp_path: Path,
) -> None:
    (tmp_path / "c.con.xml").write_text(
        '<connections><crossing node="b" edges="east_1 west_2" priority="true"/></connections>'
    )
    build(tmp_path, *WALKS, "--connection-files", "c.con.xml")
    aside = '<flow id="aside" begin="0" end="300" vehsPerHour="120" from="south" to="east_2"/>'
    found = inspect(configure(tmp_path, CARS + aside))
    assert "30 of 40 cars of the demand drive over a crossing" in finding(found, "ego routes").text
    # From 20 m before the crossing on one side of the road to 20 m behind it on the other.
    (walk,) = walks_over(found.network, found.routes)
    ends = {walk.origin: walk.depart_m, walk.destination: walk.arrival_m}
    before = found.network.lanes["east_1_0"].length - 20.0
    assert ends == {"east_1": pytest.approx(before), "west_2": pytest.approx(20.0)}
    back = walk.back()
    assert {back.destination: back.arrival_m, back.origin: back.depart_m} == ends
    assert (back.origin, back.destination) == (walk.destination, walk.origin)


def test_ego_routes_follow_the_network_and_pass_every_crossing_that_they_name(tmp_path: Path) -> None:
    found = inspect(build(tmp_path, *WALKS, *CROSSINGS))
    assert found.routes[0].crossings
    assert {name for route in found.routes for name in route.crossings} == set(found.network.crossings)
    for route in found.routes:
        for edge, following in pairwise(route.edges):
            lanes = found.network.edges[edge]
            assert any(found.network.follow(lane, following, "passenger") for lane in lanes)
        for name in route.crossings:
            assert found.network.crossings[name].edges & set(route.edges)


def test_an_ego_route_in_a_grid_goes_through_no_junction_twice(tmp_path: Path) -> None:
    size = "--grid --grid.number 3 --grid.length 150 --sidewalks.guess --crossings.guess --no-turnarounds"
    call_line(f"netgenerate {size} -o grid.net.xml", tmp_path)
    found = inspect(tmp_path / "grid.net.xml")
    assert found.possible
    for route in found.routes:
        # netgenerate calls an edge by the two junctions that it joins, of two letters each.
        junctions = [edge[2:] for edge in route.edges[:-1]]
        assert len(set(junctions)) == len(junctions) > 0
        assert len(set(route.edges)) == len(route.edges)


@pytest.mark.long
def test_a_demand_without_persons_gets_some_by_the_suggested_command(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    path = configure(tmp_path, CARS)
    found = inspect(path)
    assert missing(found) == {"persons"}
    assert finding(found, "vehicles").text == "30 passenger"
    call_line(finding(found, "persons").command, tmp_path)
    text = path.read_text().replace("town.rou.xml", "town.rou.xml,town-persons.rou.xml")
    path.write_text(text)
    mended = inspect(path)
    assert mended.possible
    assert mended.demand.persons == pytest.approx(50, abs=2)  # 600 an hour for 300 s


def test_an_unsorted_route_file_is_mended_by_the_suggested_command(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    late = '<trip id="late" depart="20" from="east_1" to="east_2"/>'
    early = '<trip id="early" depart="5" from="east_1" to="east_2"/>'
    path = configure(tmp_path, PERSONS + late + early)
    found = inspect(path)
    one = finding(found, "route order")
    assert one.level is Level.DANGER
    assert "1 entries, first 'early'" in one.text
    assert found.possible
    assert "route order" in found.verdict
    assert found.demand.vehicles["passenger"] == 1
    call_line(one.command, tmp_path)
    path.write_text(path.read_text().replace("town.rou.xml", "town-sorted.rou.xml"))
    mended = inspect(path)
    assert mended.demand.ignored == {}
    assert mended.demand.vehicles["passenger"] == 2


@pytest.mark.sumo
def test_sumo_leaves_out_and_inserts_what_is_said(tmp_path: Path) -> None:
    """Another reader of the same files, SUMO itself, is the judge."""
    build(tmp_path, *WALKS, *CROSSINGS)
    trips = "".join(
        f'<trip id="t{depart}" depart="{depart}" from="east_1" to="east_2"/>' for depart in (3, 9, 4, 12, 8)
    )
    flow = '<flow id="f" begin="11" end="41" period="10" from="west_1" to="west_2"/>'
    later = '<flow id="g" begin="15" end="75" number="6" from="west_1" to="west_2"/>'
    # The simulation ends at 300 s: half of the first, and 9 of the other, which is one every 10 s.
    cut = '<flow id="h" begin="200" end="400" number="10" from="west_1" to="west_2"/>'
    cut += '<flow id="i" begin="210" number="20" vehsPerHour="360" from="west_1" to="west_2"/>'
    path = configure(tmp_path, PERSONS + trips + flow + later + cut)
    found = inspect(path)
    assert found.demand.vehicles["passenger"] == 3 + 6 + 5 + 9
    assert found.demand.ignored == {tmp_path / "town.rou.xml": ["t4", "t8", "f"]}
    call_line("sumo -c town.sumocfg --no-warnings --statistic-output s.xml --tripinfo-output t.xml", tmp_path)
    statistics = (tmp_path / "s.xml").read_text()
    assert f'<vehicles loaded="{found.demand.vehicles["passenger"]:.0f}"' in statistics
    assert f'<persons loaded="{found.demand.persons:.0f}"' in statistics


@pytest.mark.parametrize(
    ("options", "step", "check", "level", "words"),
    [
        ('<pedestrian.model value="nonInteracting"/>', "0.1", "pedestrian model", Level.MISSING, "through"),
        ('<pedestrian.model value="jupedsim"/>', "0.1", "pedestrian model", Level.DANGER, "SUMO 1.28 hangs"),
        ('<mesosim value="true"/>', "0.1", "mesoscopic", Level.MISSING, "remove mesosim"),
        ('<ignore-route-errors value="true"/>', "0.1", "route errors", Level.DANGER, "silently"),
        ('<step-method.ballistic value="true"/>', "0.1", "options", Level.NOTE, "ballistic"),
        ('<collision.action value="none"/>', "0.1", "options", Level.NOTE, "collision.action none"),
        ('<time-to-teleport value="5"/>', "0.1", "options", Level.NOTE, "after 5 s"),
        ('<time-to-teleport.highways value="9"/>', "0.1", "options", Level.NOTE, "after 9 s"),
        ('<intermodal-collision.action value="remove"/>', "0.1", "options", Level.NOTE, "action remove"),
        ("", "0.1", "options", Level.NOTE, "in junctions"),
        ("", "2", "step length", Level.MISSING, "0.05 to 1 s"),
        ("", "1", "step length", Level.NOTE, "1 s"),
        ("", "0.1", "step length", Level.GOOD, "0.1 s"),
    ],
)
def test_options_that_matter_are_named(
    tmp_path: Path, options: str, step: str, check: str, level: Level, words: str
) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    found = inspect(configure(tmp_path, PERSONS + CARS, options, step))
    one = finding(found, check)
    assert one.level is level
    assert words in one.text
    assert found.possible is (level is not Level.MISSING)


def test_options_that_are_all_set_well_are_not_mentioned(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    good = (
        '<time-to-teleport value="-1"/><collision.action value="warn"/>'
        '<collision.check-junctions value="true"/>'
    )
    found = inspect(configure(tmp_path, PERSONS + CARS, good))
    assert "options" not in {one.check for one in found.findings}


def test_types_that_the_sublane_model_excludes_are_named_where_they_are_used(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    types = "".join(
        f'<vType id="{name}" laneChangeModel="{model}"/>'
        for name, model in (("plain", "LC2013"), ("free", "SL2015"), ("idle", "LC2013"))
    )
    mixed = '<vTypeDistribution id="mixed" vTypes="plain free"/>'
    car = '<trip id="mine" type="mixed" depart="299" from="east_1" to="east_2"/>'
    found = inspect(configure(tmp_path, types + mixed + PERSONS + CARS + car))
    one = finding(found, "lane-change model")
    assert one.level is Level.NOTE
    assert "'plain' has laneChangeModel LC2013" in one.text
    assert "--actuation move" in one.text
    write_scaffold(found, tmp_path / "made")
    assert 'actuation = "move"' in (tmp_path / "made" / "scenario.toml").read_text()
    unused = inspect(configure(tmp_path, types + mixed + PERSONS + CARS))
    assert "lane-change model" not in {one.check for one in unused.findings}


def test_what_rerouters_close_during_the_run_is_named(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    path = configure(tmp_path, PERSONS + CARS)
    text = path.read_text().replace("</input>", '<additional-files value="works.add.xml"/></input>')
    path.write_text(text)
    intervals = (
        '<interval begin="{}" end="{}"><closingLaneReroute id="east_2_1" disallow="all"/></interval>'
        '<interval begin="900" end="1000"><closingReroute id="west_1"/></interval>'
    )
    for begin, end, closed in ((0, 100, True), (300, 400, False)):
        works = f'<rerouter id="works" edges="east_1">{intervals.format(begin, end)}</rerouter>'
        (tmp_path / "works.add.xml").write_text(f"<additional>{works}</additional>")
        found = inspect(path)
        assert ("closed lanes" in {one.check for one in found.findings}) is closed
        if closed:
            one = finding(found, "closed lanes")
            assert one.level is Level.DANGER
            assert "close east_2_1: " in one.text
            assert found.possible


def test_what_is_closed_to_cars_gives_no_ego_route(tmp_path: Path) -> None:
    net = build(tmp_path, *WALKS, *CROSSINGS, "--keep-edges.by-vclass", "passenger")
    assert inspect(net).routes
    text = net.read_text().replace('disallow="pedestrian', 'disallow="passenger pedestrian')
    net.write_text(text)
    found = inspect(net)
    assert {"roads", "ego routes"} <= missing(found)
