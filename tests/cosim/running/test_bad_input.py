"""Wrong things, typed as a user would: one line, exit code 2, no folder left; beside those in test_cli."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

from controllers import catalog
from cosim.errors import InputError
from cosim.running import compose, inventory
from cosim.running.rehearsal import rehearse
from tests.cosim.cli.test_cli import configuration, network, refused

ROUTE = ("--ego-route", "e1 e2")


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def town(tmp_path: Path) -> Path:
    return network(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "solver=nonsense"], ["unknown solver 'nonsense'", "osqp"]),
        (["--set", "tolerance=-1"], ["tolerance"]),
        (["--set", "steps=1"], ["at least 2"]),
        (["--set", "model=paper"], ["--controller vo_paper"]),
        (["--set", "euler_steps=9"], ["--controller vo_ga or vo_paper has it"]),
        (["--set", "cone=square"], ["'hybrid'"]),
        (["--set", "=3"], ["key=value"]),
        (["--controller", "aeb", "--set", "friction=0"], ["expected more than 0"]),
        (
            ["--controller", "sumo", "--set", "solver=osqp"],
            ["controller 'sumo' has none", "vo_mpc or vo_paper has it"],
        ),
        (["--ego-vehicle", ""], ["id of a vehicle"]),
        (["--ego-share", "nan"], ["at most 1"]),
        (["--ego-share", "many"], ["number"]),
        (["--duration-s", "inf"], ["above 0"]),
        (["--duration-s", "0"], ["above 0"]),
        (["--seed", "1.5"], ["integer"]),
        (["--ego-route", "a b", "--ego-vehicle", "x", "--ego-share", "0.1"], ["exclude each other"]),
    ],
)
def test_a_wrong_value_is_refused_before_a_simulation_starts(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    words: list[str],
) -> None:
    def started(*_: object, **__: object) -> None:
        raise AssertionError("SUMO was started")

    monkeypatch.setattr(compose, "SumoWorld", started)
    line = refused(capsys, "run", "midblock_zebra", *arguments)
    assert all(word in line for word in words)


def test_a_word_that_is_no_command_is_answered_by_one_that_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert "'run'" in refused(capsys, "rum", "midblock_zebra")
    assert "SCENARIO" in refused(capsys, "run")
    assert "scenarios" in refused(capsys, "list", "everything")


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("n.net.xml", b"<net/>", "has no edges"),
        ("n.net.xml", b"<routes/>", "expected a SUMO network"),
        ("n.net.xml.gz", b"<net/>", "Not a gzipped file"),
        ("n.net.xml.gz", gzip.compress(b"<net>" + bytes(9000) + b"</net>", mtime=0)[:60], "n.net.xml.gz"),
    ],
    ids=["empty", "routes", "not-packed", "cut-off"],
)
def test_what_is_no_network_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str, content: bytes, words: str
) -> None:
    (tmp_path / name).write_bytes(content)
    configuration(tmp_path, net=name)
    assert words in refused(capsys, "run", "town.sumocfg", *ROUTE)


def test_a_network_is_no_configuration(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "n.net.xml").write_text("<net/>")
    assert "expected a SUMO <configuration>" in refused(capsys, "run", "n.net.xml", *ROUTE)
    assert "no scenario.toml" in refused(capsys, "run", str(tmp_path), *ROUTE)


@pytest.mark.sumo
def test_what_sumo_does_not_take_is_told_in_its_words(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, town: Path
) -> None:
    files = '<route-files value="r.rou.xml"/>'
    configuration(tmp_path, extra=files)
    assert "r.rou.xml" in refused(capsys, "run", "town.sumocfg", *ROUTE)
    for content, words in (
        ('<vehicle id="x" depart="0"><route edges="e1 gone"/></vehicle>', "gone"),
        ('<vehicle id="x" depart="0" type="tank"><route edges="e1 e2"/></vehicle>', "tank"),
    ):
        (tmp_path / "r.rou.xml").write_text(f"<routes>{content}</routes>")
        assert words in refused(capsys, "run", "town.sumocfg", *ROUTE)
    configuration(tmp_path, extra='</input><processing><no-such-option value="3"/></processing><input>')
    assert "no-such-option" in refused(capsys, "run", "town.sumocfg", *ROUTE)
    configuration(tmp_path)
    assert "departLane" in refused(capsys, "run", "town.sumocfg", *ROUTE, "--set", "ego_depart_lane=99")
    assert "tank" in refused(capsys, "run", "town.sumocfg", *ROUTE, "--set", "ego_vehicle_type=tank")
    assert not list(tmp_path.glob("runs/*"))


@pytest.mark.sumo
def test_recording_everybody_where_nobody_comes_is_told_as_that(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, town: Path
) -> None:
    configuration(tmp_path)
    line = refused(capsys, "run", "town.sumocfg", "--record", "everybody", "--ego-share", "0")
    assert "nobody to record" in line
    assert not list(tmp_path.glob("runs/*"))


@pytest.mark.sumo
def test_a_folder_that_cannot_be_made_is_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, town: Path
) -> None:
    (tmp_path / "file").write_text("mine")
    line = refused(capsys, "run", "town.sumocfg", *ROUTE, "--out", "file/results")
    assert "file/results" in line
    assert "Not a directory" in line


class _Broken:
    def decide(self, perception: object) -> None:
        raise RuntimeError("no\nmap")

    def plan(self, perception: object, decision: object) -> None:
        raise AssertionError("nothing was decided")


def test_a_controller_that_cannot_plan_on_a_plain_road_is_refused() -> None:
    with pytest.raises(InputError, match=r"'mine' with power=3 cannot plan .* RuntimeError: no map"):
        rehearse("mine", _Broken(), {"power": 3})  # type: ignore[arg-type]  # as broken as it can be


def test_every_controller_can_plan_on_a_plain_road() -> None:
    for name in catalog.names():
        rehearse(name, catalog.build(name), {})


def test_a_plug_in_that_cannot_be_loaded_hides_no_other_controller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken_driver.py").write_text("raise SystemExit(0)\n")
    about = tmp_path / "broken-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[cosim.controllers]\nbroken = broken_driver\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    found = {entry.name: entry.description for entry in inventory.controllers()}
    assert found["broken"] == "not usable: controller 'broken' cannot be loaded: SystemExit: 0"
    assert found["vo_mpc"].endswith(".")
