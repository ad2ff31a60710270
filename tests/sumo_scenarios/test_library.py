"""Scenarios are found, read and changed; what is wrong is said in one line."""

from __future__ import annotations

import gzip
import pickle
from pathlib import Path

import pytest

from sumo_scenarios.library import (
    ScenarioError,
    load,
    names,
    parameter_names,
    prepare,
    with_egos,
    with_parameters,
)

BUILT_IN = (
    "braunschweig",
    "braunschweig_calibrated",
    "bus_stop_occlusion",
    "decision_rules",
    "jaywalk_arterial",
    "midblock_unmarked",
    "midblock_zebra",
    "signalised_junction",
)


def write_configuration(folder: Path, net: str = "a.net.xml", more: str = "") -> Path:
    (folder / "a.net.xml").write_text("<net/>")
    path = folder / "mine.sumocfg"
    path.write_text(f'<configuration><input><net-file value="{net}"/></input>{more}</configuration>')
    return path


def message_of(name: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        load(name)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_every_folder_with_a_definition_is_a_scenario() -> None:
    assert names() == BUILT_IN


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_built_in_scenario_loads_and_travels_to_another_process(name: str) -> None:
    scenario = load(name)
    assert scenario.name == name
    assert scenario.description
    assert 0.05 <= scenario.step_s <= 1.0
    assert pickle.loads(pickle.dumps(scenario)) == scenario


def test_braunschweig_takes_time_and_step_from_the_shipped_configuration() -> None:
    scenario = load("braunschweig")
    assert (scenario.begin_s, scenario.step_s, scenario.egos.share) == (54000.0, 0.05, 0.2)
    assert scenario.vehicles_per_hour is None


def test_an_unknown_scenario_names_those_that_exist() -> None:
    text = message_of("midblock_zebrah")
    assert all(name in text for name in BUILT_IN)


def test_texts_become_values_and_unknown_keys_come_back() -> None:
    scenario, leftover = with_parameters(
        load("midblock_zebra"),
        {"pedestrians_per_hour": "600", "step_s": "0.05", "ego_count": "2", "horizon": "30"},
    )
    assert (scenario.pedestrians_per_hour, scenario.step_s, scenario.egos.count) == (600.0, 0.05, 2)
    assert leftover == {"horizon": "30"}


def test_every_parameter_name_is_accepted() -> None:
    texts = {
        "actuation": "move",
        "turn": "left",
        "ego_vehicle_type": "van",
        "ego_depart_lane": "2",
        "warmup_s": "1",
        "step_s": "0.5",
        "ego_share": "0.5",
        "hidden_by": "nothing",
        "accepted_gap_s": "5",
        "watchful_share": "0.5",
        "walking_speed_mps": "2",
        "gap_to_front_m": "2",
        "bus_length_m": "10",
        "ahead": "braking_car",
        "ahead_lane": "2",
        "ahead_braking_mps2": "5",
        "ahead_stands_s": "5",
    }
    for name in names():
        scenario = load(name)
        for key in parameter_names(scenario):
            assert with_parameters(scenario, {key: texts.get(key, "200")})[1] == {}


def test_moving_needs_no_sublane_model_and_hybrid_does() -> None:
    moved, _ = with_parameters(load("midblock_zebra"), {"actuation": "move"})
    assert moved.lateral_resolution_m is None
    assert with_parameters(moved, {"actuation": "hybrid"})[0].lateral_resolution_m == 0.4


@pytest.mark.parametrize(("turn", "exit_edge"), [("right", "east"), ("straight", "north"), ("left", "west")])
def test_the_turn_chooses_the_route_of_the_egos(turn: str, exit_edge: str) -> None:
    scenario, _ = with_parameters(load("signalised_junction"), {"turn": turn})
    assert len(scenario.egos.routes) == 4
    assert scenario.egos.routes[0] == ("south_in", "south_approach", f"{exit_edge}_exit", f"{exit_edge}_out")


@pytest.mark.parametrize(
    ("name", "key", "text", "expected"),
    [
        ("midblock_zebra", "pedestrians_per_hour", "many", "a number"),
        ("midblock_zebra", "pedestrians_per_hour", "-1", "at least 0"),
        ("midblock_zebra", "pedestrians_per_hour", "nan", "at least 0"),
        ("midblock_zebra", "step_s", "2.0", "at least 0.05 and at most 1"),
        ("midblock_zebra", "actuation", "teleport", "hybrid, move"),
        ("midblock_zebra", "warmup_s", "9999", "less than duration_s"),
        ("midblock_zebra", "ego_count", "1.5", "whole number"),
        ("signalised_junction", "turn", "back", "right, straight, left"),
        ("signalised_junction", "bicycles_per_hour", "-3", "at least 0"),
        ("braunschweig", "ego_share", "1.5", "at most 1"),
    ],
)
def test_a_wrong_value_says_what_was_expected(name: str, key: str, text: str, expected: str) -> None:
    with pytest.raises(ScenarioError, match=expected):
        with_parameters(load(name), {key: text})


def test_egos_can_be_given_from_outside(tmp_path: Path) -> None:
    scenario = load(str(write_configuration(tmp_path)))
    assert with_egos(scenario, route=["e1", "e2"]).egos.routes == (("e1", "e2"),)
    assert with_egos(scenario, route=["e1", "e2"]).egos.count == 1
    assert with_egos(scenario, vehicle=["v1"]).egos.vehicles == ("v1",)
    assert with_egos(load("midblock_zebra"), share=0.1).egos.routes == ()
    with pytest.raises(ScenarioError, match="at most 1"):
        with_egos(scenario, share=1.5)
    with pytest.raises(ScenarioError, match="expected a route"):
        with_egos(scenario)


def test_a_configuration_gives_times_and_files(tmp_path: Path) -> None:
    more = '<time><begin value="1:0:0"/><e v="4000"/><step-length value="0.25"/></time>'
    path = write_configuration(tmp_path, "b.net.xml.gz", more)
    (tmp_path / "b.net.xml.gz").write_bytes(gzip.compress(b"<net/>"))
    scenario = load(str(path))
    assert (scenario.begin_s, scenario.duration_s, scenario.step_s) == (3600.0, 400.0, 0.25)
    prepared = prepare(scenario, 1, tmp_path)
    assert set(prepared.inputs) == {"mine.sumocfg", "b.net.xml.gz"}
    assert prepared.options[0] == "--configuration-file"


def test_variables_of_the_environment_stand_for_any_value_of_a_configuration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORNING", "1:00:00")
    monkeypatch.setenv("QUEUES", "true")
    more = '<time><begin value="${MORNING}"/><end value="4000"/></time>'
    scenario = load(str(write_configuration(tmp_path, more=more)))
    assert (scenario.begin_s, scenario.duration_s) == (3600.0, 400.0)
    path = write_configuration(tmp_path, more='<mesosim value="${QUEUES}"/>')
    with pytest.raises(ScenarioError, match="mesosim is set"):
        load(str(path))


@pytest.mark.parametrize("in_folder", [False, True])
@pytest.mark.parametrize(
    ("more", "after"),
    [
        ("", "300"),
        ('<time-to-teleport value="5"/>', "300"),
        ('<time-to-teleport value="900"/>', "900"),
        ('<time-to-teleport value="-1"/>', "-1"),
    ],
)
def test_vehicles_are_teleported_as_the_configuration_says_but_never_soon(
    tmp_path: Path, in_folder: bool, more: str, after: str
) -> None:
    """Whether it is named itself, or by a scenario.toml."""
    path = write_configuration(tmp_path, more=f"<processing>{more}</processing>")
    (tmp_path / "scenario.toml").write_text(
        'description = "mine"\nduration_s = 60.0\nsumocfg = "mine.sumocfg"\n[egos]\nshare = 0.5\n'
    )
    options = prepare(load(str(tmp_path if in_folder else path)), 1, tmp_path / "work").options
    assert options[options.index("--time-to-teleport") + 1] == after


def test_vehicles_of_a_scenario_without_a_configuration_are_never_teleported(tmp_path: Path) -> None:
    options = prepare(load("midblock_zebra"), 1, tmp_path).options
    assert options[options.index("--time-to-teleport") + 1] == "-1"


@pytest.mark.parametrize(
    ("net", "more", "expected"),
    [
        ("b.net.xml", "", "b.net.xml: no such file"),
        ("", "", "names no network"),
        ("a.net.xml", '<mesosim value="true"/>', "mesosim is set; expected a microscopic simulation"),
        ("a.net.xml", "<time>", "not well-formed XML"),
        ("a.net.xml", '<input><route-files value="r.xml"/></input>', "r.xml: no such file"),
        ("a.net.xml", '<time><begin value="soon"/></time>', "begin is 'soon'"),
        ("a.net.xml", '<time><begin value="9"/><end value="3"/></time>', "expected more than begin"),
        ("mine.sumocfg", "", "expected a SUMO network"),
    ],
)
def test_a_bad_configuration_is_one_line(tmp_path: Path, net: str, more: str, expected: str) -> None:
    more = more or '<time><step-length value="0.1"/></time>'
    assert expected in message_of(str(write_configuration(tmp_path, net, more)))


def test_a_step_out_of_bounds_is_refused_unless_another_is_asked_for(tmp_path: Path) -> None:
    path = write_configuration(tmp_path, "a.net.xml", '<time><step-length value="2.0"/></time>')
    scenario = load(str(path))
    with pytest.raises(ScenarioError, match=r"step-length is 2 s; expected 0\.05 to 1 s"):
        prepare(scenario, 1, tmp_path / "refused")
    asked, _ = with_parameters(scenario, {"step_s": "0.1"})
    options = prepare(asked, 1, tmp_path / "work").options
    assert options[options.index("--step-length") + 1] == "0.1"


def test_a_broken_gzip_is_one_line(tmp_path: Path) -> None:
    path = write_configuration(tmp_path, "b.net.xml.gz", '<time><step-length value="0.1"/></time>')
    (tmp_path / "b.net.xml.gz").write_bytes(b"<net/>")
    assert "cannot be read" in message_of(str(path))


DEFINITION = """
description = "mine"
duration_s = 10.0
[network]
nodes = "n.xml"
edges = "e.xml"
[demand]
routes = ["r.xml"]
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (DEFINITION + "lanes = 3", "unknown key 'demand.lanes'; keys that exist here: routes, additional"),
        ("color = 3\n" + DEFINITION, "unknown key 'color'; keys that exist here: description, duration_s"),
        (
            DEFINITION.replace("10.0", '"long"'),
            "key 'duration_s': input should be a valid number, got",
        ),
        (DEFINITION.replace("10.0", "-1.0"), "key 'duration_s': input should be greater than 0"),
        (DEFINITION.replace('description = "mine"', ""), "key 'description' is missing"),
        ("step_s = 2.0\n" + DEFINITION, "key 'step_s': input should be less than or equal to 1"),
        ('sumocfg = "a"\n' + DEFINITION, "expected exactly one of"),
        (DEFINITION + '[rates]\nx = { of = "trams", share = 1.0 }', "there are: pedestrians_per_hour"),
        (DEFINITION + '[[egos.routes]]\nedges = "a"\nwhen = { turn = "x" }', "parameters that exist: none"),
        *(
            (
                DEFINITION + f'{more}\n[parameters.{name}]\ndefault = 1.0\ndescription = "x"',
                f"key 'parameters.{name}': the name is taken; expected none of actuation, ",
            )
            for name, more in (
                ("duration_s", ""),
                ("ego_headway_s", ""),
                ("end_s", ""),
                ("vehicles_per_hour", "vehicles_per_hour = 300.0"),
                ("cars_per_s", '[rates]\ncars_per_s = { of = "cars_per_s", share = 1.0 }'),
                ("soon_s", "[times]\nsoon_s = 1.0"),
            )
        ),
        (DEFINITION + "= 3", "not valid TOML"),
    ],
)
def test_a_bad_definition_names_file_and_key(tmp_path: Path, text: str, expected: str) -> None:
    (tmp_path / "scenario.toml").write_text(text)
    message = message_of(str(tmp_path))
    assert message.startswith(str(tmp_path / "scenario.toml"))
    assert expected in message


def test_a_folder_without_a_definition_says_so(tmp_path: Path) -> None:
    assert "has no scenario.toml" in message_of(str(tmp_path))
