"""Demand at which SUMO stops, and demand like it that SUMO accepts, with SUMO as the judge."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from cosim.inspection.finding import Level
from cosim.inspection.inspection import inspect
from tests.cosim.inspection.found import finding, missing
from tests.cosim.inspection.towns import CARS, CROSSINGS, PERSONS, WALKS, build, call_line, configure


def stops_sumo(folder: Path) -> bool:
    """Return whether SUMO itself stops with an error."""
    try:
        call_line("sumo -c town.sumocfg --no-warnings", folder)
    except subprocess.CalledProcessError:
        return True
    return False


GAP = '<route edges="east_1 west_1"/>'


@pytest.mark.parametrize(
    "vehicle",
    [
        '<trip id="lost" depart="5" from="gone" to="east_2"/>',
        '<trip id="lost" depart="5" from="east_2" to="east_1"/>',
        f'<vehicle id="lost" depart="5">{GAP}</vehicle>',
        f'<route id="r" {GAP[7:]}<vehicle id="lost" depart="5" route="r"/>',
        f'<vType id="bus" vClass="bus"/><vehicle id="lost" depart="5" type="bus">{GAP}</vehicle>',
        f'<routeDistribution id="d"><route edges="east_1 east_2" probability="0"/>{GAP}</routeDistribution>'
        '<vehicle id="lost" depart="5" route="d"/>',
        f'<route id="r" {GAP[7:]}<routeDistribution id="d" routes="r" probabilities="3"/>'
        '<vehicle id="lost" depart="5" route="d"/>',
    ],
)
@pytest.mark.sumo
def test_a_vehicle_that_sumo_stops_at_is_told(tmp_path: Path, vehicle: str) -> None:
    build(tmp_path, *WALKS, *CROSSINGS, "--no-turnarounds")
    path = configure(tmp_path, PERSONS + CARS + vehicle)
    one = finding(inspect(path), "car routes")
    assert one.level is Level.DANGER
    assert one.text.startswith("1 vehicle of the demand has")
    assert stops_sumo(tmp_path)


@pytest.mark.parametrize(
    ("demand", "words"),
    [
        ('<trip id="v" type="b" depart="5" from="east_1" to="east_2"/>', "trip 'v' has the type 'b'"),
        ('<vehicle id="v" route="b" depart="5"/>', "vehicle 'v' has the route 'b'"),
        (
            '<person id="p" type="b" depart="5"><walk from="east_1" to="west_2"/></person>',
            "person 'p' has the",
        ),
        ('<vTypeDistribution id="d" vTypes="b"/>', "vTypeDistribution 'd' has the type 'b'"),
        ('<routeDistribution id="d" routes="b"/>', "routeDistribution 'd' has the route 'b'"),
        (
            '<trip id="v" type="b" depart="5" from="east_1" to="east_2"/><vType id="b"/>',
            "the type 'b', which is defined only below it: ",
        ),
        (
            '<vehicle id="v" route="b" depart="5"/><route id="b" edges="east_1 east_2"/>',
            "the route 'b', which is defined only below it: ",
        ),
    ],
)
@pytest.mark.sumo
def test_types_and_routes_that_no_file_defines_are_named(tmp_path: Path, demand: str, words: str) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    found = inspect(configure(tmp_path, PERSONS + CARS + demand))
    assert missing(found) == {"types and routes"}
    assert words in finding(found, "types and routes").text
    assert stops_sumo(tmp_path)


@pytest.mark.parametrize(
    "demand",
    [
        '<vehicle id="late" depart="305"><route edges="east_1 west_1"/></vehicle>',
        '<route id="unused" edges="east_1 west_1"/>',
        '<vType id="b"/><vTypeDistribution id="d" vTypes="b"/><route id="r" edges="east_1 east_2"/>'
        '<routeDistribution id="e" routes="r"/><flow id="v" type="d" route="e" begin="5" end="9" number="2"/>',
        '<vTypeDistribution id="d"><vType id="b"/></vTypeDistribution>'
        '<trip id="v" type="b" depart="5" from="east_1" to="east_2"/>',
        '<person id="p" type="DEFAULT_BIKETYPE" depart="5"><walk from="east_1" to="west_2"/></person>',
        '<trip id="v" type="DEFAULT_RAILTYPE" depart="5" from="east_1" to="east_2"/>',
    ],
)
@pytest.mark.sumo
def test_types_and_routes_that_sumo_accepts_are_not_called_unknown(tmp_path: Path, demand: str) -> None:
    build(tmp_path, *WALKS, *CROSSINGS, "--no-turnarounds")
    found = inspect(configure(tmp_path, PERSONS + CARS + demand))
    assert {"types and routes", "car routes"}.isdisjoint(one.check for one in found.findings)
    assert not stops_sumo(tmp_path)


@pytest.mark.parametrize(
    "stage",
    [
        '<walk edges="east_1 gone"/>',
        '<walk from="east_1" to="gone"/>',
        '<personTrip from="gone" to="east_1"/>',
    ],
)
@pytest.mark.sumo
def test_a_person_whose_plan_has_an_edge_that_does_not_exist_is_told(tmp_path: Path, stage: str) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    lost = f'<person id="lost" depart="5">{stage}</person>'
    found = inspect(configure(tmp_path, PERSONS + CARS + lost))
    assert missing(found) == {"plans of persons"}
    assert "person 'lost' goes along edge 'gone'" in finding(found, "plans of persons").text
    assert stops_sumo(tmp_path)
