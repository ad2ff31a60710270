"""Networks and demand: the same bytes for the same inputs, and the roads that the READMEs promise."""

from __future__ import annotations

import warnings
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from sumo_scenarios.library import Scenario, ScenarioError, load, names, prepare, with_parameters

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import sumolib

TURNS = ("right", "straight", "left")
OWN = tuple(name for name in names() if load(name).sumocfg is None)


def read_net(name: str, work_dir: Path) -> Any:
    file = str(prepare(load(name), 1, work_dir).net_file)
    # With lxml it does not read which edges a crossing crosses.
    return sumolib.net.readNet(file, withInternal=True, withPedestrianConnections=True, lxml=False)


def crossings(net: Any) -> list[Any]:
    return [edge for edge in net.getEdges() if edge.getFunction() == "crossing"]


def has_priority(net: Any, crossing: Any) -> bool:
    """Return whether pedestrians enter the crossing with priority (state M) or without (m)."""
    states = {
        connection.getState()
        for incoming in crossing.getIncoming()
        if incoming.getFunction() == "walkingarea"
        for connection in incoming.getOutgoing()[crossing]
    }
    assert len(states) == 1
    return states == {"M"}


@pytest.mark.parametrize("name", names())
def test_preparing_twice_gives_the_same_bytes(name: str, tmp_path: Path) -> None:
    one, two = (prepare(load(name), 7, tmp_path / folder) for folder in "ab")
    assert one.inputs == two.inputs
    assert one.net_file == two.net_file
    for file in (tmp_path / "a").glob("*"):
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


@pytest.mark.parametrize("name", names())
def test_no_machine_path_enters_the_names_of_the_inputs(name: str, tmp_path: Path) -> None:
    inputs = prepare(load(name), 1, tmp_path).inputs
    assert inputs
    assert not any(key.startswith("/") or str(tmp_path) in key or "\\" in key for key in inputs)


@pytest.mark.parametrize("name", OWN)
def test_no_option_is_given_twice(name: str, tmp_path: Path) -> None:
    keys = [option for option in prepare(load(name), 1, tmp_path).options if option.startswith("--")]
    assert len(keys) == len(set(keys))


def test_a_network_is_built_once_and_has_neither_date_nor_path(
    tmp_path: Path, network_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    net_file = prepare(load("decision_rules"), 1, tmp_path).net_file
    built = net_file.stat().st_mtime_ns
    assert prepare(load("decision_rules"), 2, tmp_path).net_file.stat().st_mtime_ns == built
    content = net_file.read_bytes()
    assert b"<!--" not in content
    assert str(network_cache).encode() not in content
    monkeypatch.setenv("COSIM_CACHE_DIR", str(tmp_path / "other"))
    again = prepare(load("decision_rules"), 1, tmp_path).net_file
    assert again != net_file
    assert again.read_bytes() == content
    assert {path.name for path in again.parent.iterdir()} == {again.name, f"{again.name}.sha256"}


def test_a_network_in_the_cache_that_was_altered_is_built_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSIM_CACHE_DIR", str(tmp_path / "networks"))
    net_file = prepare(load("decision_rules"), 1, tmp_path).net_file
    content = net_file.read_bytes()
    for damaged in (content[:-100], content.replace(b'speed="13', b'speed="33')):
        assert damaged != content
        net_file.write_bytes(damaged)
        assert prepare(load("decision_rules"), 1, tmp_path).net_file.read_bytes() == content


@pytest.mark.parametrize(("name", "priority"), [("midblock_zebra", True), ("midblock_unmarked", False)])
def test_five_crossings_span_six_lanes_220_m_apart(name: str, priority: bool, tmp_path: Path) -> None:
    net = read_net(name, tmp_path)
    found = sorted(crossings(net), key=lambda edge: float(edge.getShape()[0][0]))
    places = [edge.getShape()[0][0] for edge in found]
    assert len(found) == 5
    assert [b - a for a, b in pairwise(places)] == pytest.approx([220.0] * 4)
    for crossing in found:
        assert crossing.getLength() == pytest.approx(6 * 3.25 + 2 * 1.0)
        crossed = crossing.getCrossingEdges()
        lanes = [lane for edge in crossed for lane in edge.getLanes() if lane.allows("passenger")]
        assert len(lanes) == 6
        assert has_priority(net, crossing) is priority


def test_the_decision_road_has_one_zebra(tmp_path: Path) -> None:
    net = read_net("decision_rules", tmp_path)
    (crossing,) = crossings(net)
    assert has_priority(net, crossing)
    assert crossing.getLength() == pytest.approx(4 * 3.25)


def test_the_junction_has_signals_crossings_and_turn_lanes_on_every_arm(tmp_path: Path) -> None:
    net = read_net("signalised_junction", tmp_path)
    arms = {"south", "east", "north", "west"}
    crossed = {
        edge.getID().split("_")[0] for crossing in crossings(net) for edge in crossing.getCrossingEdges()
    }
    assert crossed == arms
    assert len(crossings(net)) == 4
    assert net.getNode("junction").getType() == "traffic_light"
    for arm in arms:
        approach = net.getEdge(f"{arm}_approach")
        assert sum(lane.allows("passenger") for lane in approach.getLanes()) == 3
        turns = {c.getDirection() for edge in approach.getOutgoing().values() for c in edge if c.getTLSID()}
        assert turns == {"r", "s", "l"}


@pytest.mark.parametrize("name", [name for name in OWN if load(name).egos.routes])
def test_every_ego_route_is_connected(name: str, tmp_path: Path) -> None:
    net = read_net(name, tmp_path)
    scenarios: list[Scenario] = [load(name)]
    if "turn" in scenarios[0].parameters:
        scenarios = [
            with_parameters(scenarios[0], {"turn": turn})[0] for turn in ("right", "straight", "left")
        ]
    for scenario in scenarios:
        for route in scenario.egos.routes:
            edges = [net.getEdge(edge) for edge in route]
            assert all(b in a.getOutgoing() for a, b in pairwise(edges))


def test_the_demand_parameters_change_the_flows_and_their_hash(tmp_path: Path) -> None:
    slow = prepare(load("midblock_zebra"), 1, tmp_path / "a")
    busy, _ = with_parameters(load("midblock_zebra"), {"vehicles_per_hour": "1200"})
    busier = prepare(busy, 1, tmp_path / "b")
    assert "exp(0.166666667)" in (tmp_path / "a" / "demand.rou.xml").read_text()
    assert "exp(0.333333333)" in (tmp_path / "b" / "demand.rou.xml").read_text()
    different = {key for key in slow.inputs if slow.inputs[key] != busier.inputs[key]}
    assert different == {"demand.rou.xml"}


FOLDER = {
    "scenario.toml": 'description = "mine"\nduration_s = 10.0\n[network]\nnodes = "n.xml"\nedges = "e.xml"\n'
    '[demand]\nroutes = ["r.xml"]\nvehicles_per_hour = 60.0\n',
    "n.xml": '<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/></nodes>',
    "e.xml": '<edges><edge id="ab" from="a" to="b"/></edges>',
    "r.xml": "<routes/>",
}


@pytest.mark.parametrize(
    ("file", "text", "expected"),
    [
        ("e.xml", None, "e.xml: cannot be read: No such file"),
        (
            "e.xml",
            '<edges><edge id="ab" from="a" to="c"/></edges>',
            "cannot build the network: Error",
        ),
        ("r.xml", None, "r.xml: cannot be read: No such file"),
        ("r.xml", "<routes>", "not well-formed XML"),
        ("r.xml", "<routes>$trams</routes>", r"names \$trams; values that exist: end_s, vehicles_per_hour"),
        ("r.xml", "<routes>$ 3</routes>", "Invalid placeholder"),
    ],
)
def test_a_bad_folder_is_one_line(tmp_path: Path, file: str, text: str | None, expected: str) -> None:
    for name, content in {**FOLDER, file: text}.items():
        if content is not None:
            (tmp_path / name).write_text(content)
    scenario = load(str(tmp_path))
    with pytest.raises(ScenarioError, match=expected) as caught:
        prepare(scenario, 1, tmp_path / "work")
    assert "\n" not in str(caught.value)


def test_a_folder_of_the_users_own_is_prepared(tmp_path: Path) -> None:
    for name, content in FOLDER.items():
        (tmp_path / name).write_text(content)
    prepared = prepare(load(str(tmp_path)), 1, tmp_path / "work")
    assert set(prepared.inputs) == {"n.xml", "e.xml", "network", "r.xml"}


def test_recorded_vehicles_beside_a_network_are_part_of_the_inputs(tmp_path: Path) -> None:
    text = FOLDER["scenario.toml"].replace("[network]", 'recorded_vehicles = "v.csv"\n[network]')
    for name, content in {**FOLDER, "scenario.toml": text}.items():
        (tmp_path / name).write_text(content)
    header = "vehicle,class,edge,time_s,x_m,y_m,heading_rad,speed_mps,length_m,width_m\n"
    hashes = []
    for speed in "34":
        (tmp_path / "v.csv").write_text(f"{header}a,passenger,ab,0.0,1,2,0.5,{speed},4.5,1.8\n")
        hashes.append(prepare(load(str(tmp_path)), 1, tmp_path / "work").inputs["recorded vehicles"])
    assert hashes[0] != hashes[1]
    (tmp_path / "v.csv").write_text(f"{header}a,passenger,ab,soon,1,2,0.5,3,4.5,1.8\n")
    with pytest.raises(ScenarioError, match=r"v\.csv.*time_s is 'soon'"):
        prepare(load(str(tmp_path)), 1, tmp_path / "work")


def test_a_rate_that_no_road_takes_is_refused(tmp_path: Path) -> None:
    busy, _ = with_parameters(load("midblock_zebra"), {"vehicles_per_hour": "1e9"})
    with pytest.raises(ScenarioError, match=r"rates\.\w+ is 1e\+09 an hour; expected at most 100000"):
        prepare(busy, 1, tmp_path)
