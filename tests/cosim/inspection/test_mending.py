"""A scaffold of a network without sidewalks: what names a lane still means the lane that it meant before."""

from __future__ import annotations

import gzip
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from cosim.cli import main
from cosim.inspection.inspection import inspect
from cosim.inspection.scaffold import write_scaffold
from cosim.inspection.xml_elements import elements
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from tests.cosim.inspection.towns import build

PLACES = """
<busStop id="halt" lane="east_1_0" startPos="150" endPos="188"><access lane="west_2_0" pos="20"/></busStop>
<containerStop id="boxes" lane="east_2_1" startPos="90" endPos="110"/>
<parkingArea id="park" lane="east_2_0" startPos="20" endPos="60" roadsideCapacity="4"/>
<chargingStation id="plug" lane="west_1_0" startPos="20" endPos="60"/>
<inductionLoop id="e1" lane="east_1_1" pos="-5" period="60" file="e1.xml"/>
<instantInductionLoop id="now" lane="east_1_0" pos="30" file="now.xml"/>
<laneAreaDetector id="e2" lane="east_1_0" pos="100" length="80" period="60" file="e2.xml"/>
<laneAreaDetector id="e2s" lanes="east_1_1 east_2_1" pos="100" endPos="40" period="60" file="e2.xml"/>
<entryExitDetector id="e3" period="60" file="e3.xml">
    <detEntry lane="east_1_0" pos="20"/><detExit lane="east_2_1" pos="20"/>
</entryExitDetector>
<variableSpeedSign id="sign" lanes="east_2_0 east_2_1"><step time="0" speed="9"/></variableSpeedSign>
<rerouter id="closed" edges="east_1">
    <interval begin="0" end="100"><closingLaneReroute id="west_2_0" disallow="truck"/></interval>
</rerouter>
<route id="back" edges="west_1 north"/>
<calibrator id="more" lane="north_0" pos="5" period="60">
    <flow begin="0" end="300" route="back" vehsPerHour="60" departLane="1"/>
</calibrator>
"""
DEMAND = """
<route id="through" edges="east_1 east_2"/>
<vehicle id="bus" depart="0" route="through" departLane="0" departPos="60">
    <stop busStop="halt" duration="2"/><stop lane="east_2_1" startPos="10" endPos="30" duration="2"/>
</vehicle>
<flow id="cars" begin="0" end="300" period="4" from="east_1" to="east_2" departLane="1" arrivalLane="0"/>
<trip id="any" depart="1" from="west_1" to="west_2" departLane="free"/>
<person id="guest" depart="1" departPos="10"><walk from="west_2" busStop="halt"/></person>
<personFlow id="walkers" begin="1" end="300" period="10"><walk from="east_1" to="west_2"/></personFlow>
"""
NAMES = ("lane", "lanes")


def configure(folder: Path, places: str = PLACES, demand: str = DEMAND, signals: bool = False) -> Path:
    """Write a town without sidewalks and its files, and return its configuration."""
    build(folder, *(("--tls.set", "b") if signals else ()))
    (folder / "town.add.xml").write_text(f"<additional>{places}</additional>")
    (folder / "cars.xml").write_text(f"<routes>{demand}</routes>")
    with gzip.open(folder / "town.rou.xml.gz", "wt") as file:
        file.write('<routes><include href="cars.xml"/></routes>')
    path = folder / "town.sumocfg"
    path.write_text(
        '<configuration><net-file value="town.net.xml"/><route-files value="town.rou.xml.gz"/>'
        '<additional-files value="town.add.xml"/><end value="300"/><step-length value="0.1"/></configuration>'
    )
    return path


def parts(path: Path) -> list[ElementTree.Element]:
    return [part for _, element in elements(path) for part in element.iter()]


def lanes(path: Path) -> list[str]:
    """Return the lanes that a file names, in their order; people have their own ones."""
    keys = [
        (part, "id" if part.tag == "closingLaneReroute" else key) for part in parts(path) for key in NAMES
    ]
    named = dict.fromkeys((part, key) for part, key in keys if part.get(key) and part.tag != "access")
    return [name for part, key in named for name in part.get(key, "").split()]


def find(path: Path, tag: str, name: str = "") -> ElementTree.Element:
    """Return the first element of a kind."""
    return next(part for part in parts(path) if part.tag == tag and (not name or part.get("id") == name))


def said(folder: Path, path: Path) -> str:
    return "\n".join(write_scaffold(inspect(path), folder / "mine"))


@pytest.mark.long
@pytest.mark.sumo
def test_everything_names_the_lane_that_it_named_and_sumo_drives_to_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    configure(tmp_path)
    given = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert main(["inspect", "town.sumocfg", "--scaffold", "mine"]) == 1  # of the network as it is
    printed = capsys.readouterr().out
    for kind in ("busStop", "laneAreaDetector", "stop", "departLane of flow"):
        assert f"\n{kind}: " in printed
    assert "left out" not in printed
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == given

    before = read_network(tmp_path / "town.net.xml")
    after = read_network(tmp_path / "mine/town-crossings.net.xml")
    assert len(after.edges["east_1"]) == 3
    for old, new in (
        (tmp_path / name, tmp_path / "mine" / name) for name in ("town.add.xml", "town.rou.xml")
    ):
        old = old if old.exists() else tmp_path / "cars.xml"
        assert len(lanes(old)) > 0
        for one, other in zip(lanes(old), lanes(new), strict=True):
            assert_same_shape(before, one, after, other)
    routes = tmp_path / "mine/town.rou.xml"
    assert find(routes, "flow").get("departLane") == "2"
    assert find(routes, "flow").get("arrivalLane") == "1"
    assert find(routes, "vehicle").get("departLane") == "1"
    assert find(routes, "trip").get("departLane") == "free"
    additional = tmp_path / "mine/town.add.xml"
    assert find(additional, "flow").get("departLane") == "2"
    # People walk on the sidewalk now.
    assert find(additional, "access").get("lane") == "west_2_0"
    short = ["--duration-s", "15", "--set", "warmup_s=5", "--set", "ego_first_depart_s=1"]
    assert main(["run", "mine", "--controller", "sumo", *short, "--out", "run"]) == 0


def assert_same_shape(before: Network, old: str, after: Network, new: str) -> None:
    assert not after.lanes[new].permissions.allows("pedestrian")
    np.testing.assert_allclose(after.lanes[new].shape, before.lanes[old].shape)


def test_what_cannot_be_carried_over_is_left_out_and_named(tmp_path: Path) -> None:
    places = """
    <busStop id="gone" lane="east_9_0" startPos="1" endPos="20"/>
    <tlLogic id="b" programID="own"><phase duration="30" state="GGGGGGGGGGGG"/></tlLogic>
    """
    demand = """
    <vehicle id="bus" depart="0"><route edges="east_1 east_2"/><stop busStop="gone" duration="2"/></vehicle>
    <flow id="zone" begin="0" end="300" number="9" fromTaz="here" toTaz="there" departLane="1"/>
    <person id="guest" depart="1"><walk from="west_2" busStop="gone"/></person>
    """
    lines = said(tmp_path, configure(tmp_path, places, demand, signals=True))
    assert "busStop: 1 left out, 'gone': its lane is not in the network" in lines
    assert "stop of vehicle: 1 left out, 'bus': it needs 'gone'" in lines
    assert "person: 1 left out, 'guest': it needs 'gone'" in lines
    assert "departLane of flow: 1 left out, 'zone': only SUMO knows" in lines
    assert "tlLogic: 1 left out, 'b': its crossings have signals now" in lines
    assert parts(tmp_path / "mine/town.add.xml") == []
    left = [part.tag for part in parts(tmp_path / "mine/town.rou.xml")]
    assert left == ["vehicle", "route", "flow"]


def test_places_beyond_the_end_of_a_lane_are_moved_back(tmp_path: Path) -> None:
    places = """
    <busStop id="end" lane="east_1_0" startPos="188" endPos="205"/>
    <inductionLoop id="e1" lane="east_1_0" pos="200" file="e1.xml" period="60"/>
    <laneAreaDetector id="e2" lane="east_1_0" pos="150" length="80" file="e2.xml" period="60"/>
    """
    demand = """
    <vehicle id="bus" depart="0"><route edges="east_1 east_2"/><stop lane="east_1_0" endPos="12" duration="2"/></vehicle>
    """
    said(tmp_path, configure(tmp_path, places, demand))
    assert find(tmp_path / "mine/town.rou.xml", "stop").attrib == {
        "lane": "east_1_1",
        "endPos": "12",
        "duration": "2",
    }
    made = tmp_path / "mine/town.add.xml"
    length = read_network(tmp_path / "mine/town-crossings.net.xml").lanes["east_1_1"].length
    stop = find(made, "busStop")
    assert float(stop.get("endPos", "")) == length
    assert float(stop.get("startPos", "")) == pytest.approx(length - 10.0)
    assert float(find(made, "inductionLoop").get("pos", "")) == length
    area = find(made, "laneAreaDetector")
    assert float(area.get("pos", "")) + float(area.get("length", "")) == pytest.approx(length)


def test_a_file_that_an_additional_file_reads_is_found_from_the_copy(tmp_path: Path) -> None:
    (tmp_path / "limits.xml").write_text('<vss><step time="0" speed="9"/></vss>')
    (tmp_path / "closed.xml").write_text(
        '<rerouter><interval begin="0" end="9"><closingLaneReroute id="east_1_0"/></interval></rerouter>'
    )
    places = """
    <variableSpeedSign id="sign" lanes="east_2_0" file="limits.xml"/>
    <rerouter id="closed" edges="west_1" file="closed.xml"/>
    """
    said(tmp_path, configure(tmp_path, places))
    made = tmp_path / "mine/town.add.xml"
    assert find(made, "variableSpeedSign").get("file") == "../limits.xml"
    assert find(made, "rerouter").get("file") is None
    assert find(made, "closingLaneReroute").get("id") == "east_1_1"
