"""``cosim inspect`` as a user has it: exit codes, bad input, the map, and scenarios that run."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
import pytest

from cosim.cli import main
from sumo_scenarios.sumo_installation import packaged_file
from tests.cosim.cli.test_cli import refused
from tests.cosim.inspection.test_findings import BRAUNSCHWEIG
from tests.cosim.inspection.towns import CARS, CROSSINGS, PERSONS, WALKS, build, call_line, configure


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_exit_code_says_whether_a_study_is_possible(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    build(tmp_path)
    assert main(["inspect", "town.net.xml"]) == 1
    said = capsys.readouterr().out
    assert "cannot be run here yet: see sidewalks, crossings, ego routes" in said
    assert said.count("netconvert --sumo-net-file") == 1
    build(tmp_path, *WALKS, *CROSSINGS)
    assert main(["inspect", "town.net.xml"]) == 0
    said = capsys.readouterr().out
    assert said.splitlines()[-1] == "town.net.xml: a pedestrian study can be run here"
    assert '--ego-route "east_1 east_2"' in said


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("routes.xml", "<routes/>", "root element is <routes>"),
        ("broken.net.xml", "<net><edge", "not well-formed"),
        ("empty.net.xml", "", "not well-formed"),
        ("bare.net.xml", "<net/>", "has no edges"),
        ("packed.net.xml.gz", "<net/>", "cannot be read"),
        ("a.sumocfg", "<configuration/>", "names no network"),
        ("a.sumocfg", '<configuration><net-file value=" , "/></configuration>', "names no network"),
        (
            "a.sumocfg",
            '<configuration><net-file value="gone.net.xml"/></configuration>',
            "gone.net.xml: no such file, which a.sumocfg names",
        ),
        (
            "a.sumocfg",
            '<configuration><net-file value="a.sumocfg"/></configuration>',
            "expected a SUMO network",
        ),
        ("a.net.xml", '<net><edge id="e"><lane id="e_0"/></edge></net>', "not a complete SUMO network"),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, content: str, words: str
) -> None:
    (tmp_path / name).write_text(content)
    assert words in refused(capsys, "inspect", name)


def test_what_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "gone.net.xml: no such file" in refused(capsys, "inspect", "gone.net.xml")
    assert "cannot be read" in refused(capsys, "inspect", str(tmp_path))
    build(tmp_path, *WALKS, *CROSSINGS)
    assert ".png or .svg" in refused(capsys, "inspect", "town.net.xml", "--picture", "map.jpg")
    assert "does not exist" in refused(capsys, "inspect", "town.net.xml", "--picture", "maps/map.png")
    assert "--scaffold .: expected an empty" in refused(capsys, "inspect", "town.net.xml", "--scaffold", ".")
    configure(tmp_path, '<flow id="f" perHour="many" begin="0" from="east_1" to="east_2"/>')
    line = refused(capsys, "inspect", "town.sumocfg")
    assert "town.rou.xml: flow 'f'" in line
    assert "'many'" in line


def test_the_map_shows_every_crossing_and_has_the_same_bytes_twice(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    for name in ("one.svg", "two.svg", "one.png", "two.png"):
        assert main(["inspect", "town.net.xml", "--picture", name]) == 0
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    text = (tmp_path / "one.svg").read_text()
    assert "crossings: without priority (3)" in text
    assert "suggested ego route" in text
    assert "x [m]" in text


def test_where_no_crossing_can_be_guessed_there_is_no_scenario(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    build(tmp_path, junction=False)
    call_line("netconvert -s town.net.xml --keep-edges.explicit east_1 -o town.net.xml", tmp_path)
    assert main(["inspect", "town.net.xml", "--scaffold", "mine"]) == 2
    assert "there is no crossing in town.net.xml, nor one that netconvert guesses" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize("walks", [(), WALKS])
def test_a_network_without_lanes_inside_its_junctions_gets_them_with_its_crossings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], walks: tuple[str, ...]
) -> None:
    build(tmp_path, *walks, "--no-internal-links")
    main(["inspect", "town.net.xml"])
    (command,) = {
        line.strip()
        for line in capsys.readouterr().out.splitlines()
        if line.lstrip().startswith("netconvert")
    }
    call_line(command, tmp_path)
    assert main(["inspect", "town-crossings.net.xml"]) == 0
    assert "3 without priority" in capsys.readouterr().out


@pytest.mark.long
@pytest.mark.sumo
def test_a_scenario_made_from_a_network_alone_has_encounters(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    assert main(["inspect", "town.net.xml", "--scaffold", "mine"]) == 0
    (tmp_path / "town.net.xml").unlink()  # the folder stands for itself
    arguments = ["--controller", "aeb", "--duration-s", "60", "--out", "run"]
    assert main(["run", "mine", *arguments]) == 0
    encounters = pd.read_csv(tmp_path / "run/encounters.csv")
    assert len(encounters) >= 3
    # The walks lead over the crossings that the ego's route passes.
    walked = pd.read_parquet(tmp_path / "run/neighbours.parquet").query("phase == 'crossing'")
    assert {":b_c1", ":b_c2"} <= set(walked["crossing_id"])


@pytest.mark.long
@pytest.mark.sumo
def test_a_scenario_made_from_a_configuration_keeps_its_demand_and_options(tmp_path: Path) -> None:
    build(tmp_path, *WALKS, *CROSSINGS)
    options = '<lateral-resolution value="0.8"/><summary-output value="s.xml"/><seed value="7"/>'
    extra = '<additional-files value="more.add.xml"/>'
    path = configure(tmp_path, PERSONS + CARS, options + extra, step="0.2")
    (tmp_path / "more.add.xml").write_text(
        '<additional><edgeData id="d" file="d.xml"/><vType id="bus" vClass="bus"/></additional>'
    )
    assert main(["inspect", str(path), "--scaffold", "made/mine"]) == 0
    written = ElementTree.parse(tmp_path / "made/mine/town.sumocfg").getroot()
    values = {element.tag: element.get("value") for element in written}
    assert values == {
        "net-file": "town.net.xml",
        "route-files": "town.rou.xml",
        "additional-files": "../../more.add.xml",  # it names a file itself, so it stays where it is
        "begin": "0",
        "end": "300",
        "step-length": "0.2",
        "lateral-resolution": "0.8",
    }
    assert main(["run", "made/mine", "--controller", "aeb", "--duration-s", "40", "--out", "run"]) == 0
    seen = pd.read_parquet(tmp_path / "run/neighbours.parquet")
    assert seen["object_id"].str.startswith("walkers.").any()
    assert seen["object_id"].str.startswith("cars.").any()


@pytest.mark.long
@pytest.mark.sumo
def test_a_scenario_made_from_braunschweig_runs(tmp_path: Path) -> None:
    shutil.copytree(packaged_file(BRAUNSCHWEIG).parent / "fokr_bs_demo", tmp_path / "fokr_bs_demo")
    shutil.copyfile(packaged_file(BRAUNSCHWEIG), tmp_path / "town.sumocfg")
    assert main(["inspect", "town.sumocfg", "--scaffold", "mine"]) == 0
    arguments = ["--controller", "sumo", "--duration-s", "5", "--set", "ego_first_depart_s=0"]
    assert main(["run", "mine", *arguments, "--out", "run"]) == 0
    egos = pd.read_parquet(tmp_path / "run/egos.parquet")
    assert egos["time_s"].min() >= 54060.0
    assert egos["ego_id"].nunique() >= 1
