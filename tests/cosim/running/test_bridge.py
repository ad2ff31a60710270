"""A street under a bridge on which a car stands and people walk, all of them above the street's traffic."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
import sumo

from analysis.encounters.case import prepare, prepare_traffic
from analysis.encounters.recorded_case import read_case
from analysis.files import read_csv
from analysis.recording.levels import levels_of
from analysis.recording.reading import read_run
from cosim.running.execution import execute
from cosim.running.request import RunRequest
from cosim.sumo.levels import other_levels
from cosim.sumo.network_file import read_network

pytestmark = pytest.mark.sumo

NODES = (
    '<nodes><node id="a" x="0" y="0"/><node id="b" x="400" y="0"/>'
    '<node id="c" x="200" y="-100"/><node id="d" x="200" y="100"/></nodes>'
)
EDGES = (
    '<edges><edge id="street" from="a" to="b" numLanes="2" speed="13.89"/>'
    '<edge id="bridge" from="c" to="d" numLanes="1" speed="13.89"/></edges>'
)
# Whoever stands on the bridge stands over the street's right lane, and over the left one.
DEMAND = """<routes>
  <vType id="car" vClass="passenger" sigma="0" speedDev="0"/>
  <vehicle id="above" type="car" depart="0" departPos="95" departSpeed="0">
    <route edges="bridge"/><stop lane="bridge_1" endPos="98" duration="100"/>
  </vehicle>
  <person id="walker" depart="0" departPos="88"><walk edges="bridge" speed="0.4"/></person>
  <vehicle id="ego" type="car" depart="5" departLane="1" departSpeed="13"><route edges="street"/></vehicle>
  <vehicle id="other" type="car" depart="9" departLane="1" departSpeed="13"><route edges="street"/></vehicle>
</routes>"""
CONFIGURATION = (
    '<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>'
    '<time><end value="45"/><step-length value="0.1"/></time></configuration>'
)


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the configuration."""
    return built(tmp_path_factory.mktemp("bridge"))


def built(folder: Path, nodes: str = NODES, edges: str = EDGES, demand: str = DEMAND) -> Path:
    """Build the network and return the configuration."""
    for name, text in (("nod", nodes), ("edg", edges)):
        (folder / f"{name}.xml").write_text(text)
    options = ["--sidewalks.guess", "--sidewalks.guess.max-speed", "20", "--crossings.guess"]
    command = [str(Path(sumo.SUMO_HOME) / "bin" / "netconvert"), "-n", "nod.xml", "-e", "edg.xml", *options]
    subprocess.run([*command, "-o", "town.net.xml"], cwd=folder, check=True, capture_output=True)
    (folder / "town.rou.xml").write_text(demand)
    path = folder / "town.sumocfg"
    path.write_text(CONFIGURATION)
    return path


def test_edges_that_cross_without_a_junction_are_on_different_levels(town: Path) -> None:
    network = read_network(town.with_name("town.net.xml"))
    assert other_levels(network) == {"street": frozenset({"bridge"}), "bridge": frozenset({"street"})}


@pytest.mark.long
def test_nobody_on_a_bridge_is_in_the_way_or_struck(town: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    outcome = execute(RunRequest(str(town), controller="vo_mpc", ego_vehicle="ego", out=out))
    assert not outcome.invalid_reason
    egos, neighbours = (pd.read_parquet(out / f"{name}.parquet") for name in ("egos", "neighbours"))
    # The ego passes below both of them, and at their places in the plane.
    assert {"above", "walker"} <= set(neighbours.object_id)
    below = egos[(egos.front_x_m > 150.0) & (egos.front_x_m < 250.0)]
    assert below.speed_mps.min() > 12.0
    assert below.front_x_m.iloc[-1] > 230.0
    case = prepare(read_run(out))
    assert (len(case.overlaps), len(case.encounters), len(case.contacts)) == (0, 0, 0)


def test_traffic_on_both_levels_is_judged_apart(tmp_path: Path) -> None:
    """A crossing 15 m behind the bridge, because traffic is recorded near crossings only."""
    nodes = NODES.replace('<node id="c"', '<node id="m" x="215" y="0"/><node id="c"')
    edges = EDGES.replace('to="b"', 'to="m"').replace(
        '<edge id="bridge"',
        '<edge id="on" from="m" to="b" numLanes="2" speed="13.89"/>'
        '<edge id="back" from="m" to="a" numLanes="1" speed="13.89"/><edge id="bridge"',
    )
    demand = DEMAND.replace('<route edges="street"/>', '<route edges="street on"/>')
    town, out = built(tmp_path, nodes, edges, demand), tmp_path / "run"
    outcome = execute(RunRequest(str(town), controller="sumo", ego_share=0.0, record="everybody", out=out))
    assert not outcome.invalid_reason
    assert read_csv(out / "traffic_encounters.csv") == []
    flat = replace(read_case(out, traffic=True).run, levels=levels_of({}))
    assert {one.person.name for one in prepare_traffic(flat).encounters} == {"walker"}


def test_a_bridge_called_like_a_lane_of_the_street_is_apart_from_it(tmp_path: Path) -> None:
    edges, demand = (text.replace("bridge", "street_1") for text in (EDGES, DEMAND))
    town, out = built(tmp_path, edges=edges, demand=demand), tmp_path / "run"
    execute(RunRequest(str(town), controller="sumo", ego_vehicle="ego", out=out))
    run = read_run(out)
    assert {"walker", "above"} <= set(run.neighbours.texts["object_id"].names)
    assert set(run.egos.texts["lane"].names) == {"street_1"}
    case = prepare(run)
    assert (len(case.overlaps), len(case.encounters), len(case.contacts)) == (0, 0, 0)


@pytest.mark.long
def test_without_the_bridge_the_same_two_would_have_been_struck(town: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    execute(RunRequest(str(town), controller="vo_mpc", ego_vehicle="ego", out=out))
    flat = replace(read_run(out), levels=levels_of({}))
    case = prepare(flat)
    assert [one.vehicle_id for one in case.overlaps] == ["above"]
    assert [one.person.name for one in case.encounters] == ["walker"]
