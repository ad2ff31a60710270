"""The command line: every mistake is one line on the standard error stream and exit code 2."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cosim.cli import main
from cosim.running import inventory
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.cosim.cli.commands import source_environment

EDGE = '<edge id="{0}" from="{1}" to="{2}" numLanes="1" speed="13.9" {3}/>'


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Run a command that must be refused, and return its one line."""
    code = main(arguments)
    captured = capsys.readouterr()
    assert code == 2, captured.err
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, captured.err
    assert lines[0].startswith("cosim: ")
    assert "Traceback" not in captured.err
    return lines[0]


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def network(folder: Path, permissions: str = "") -> Path:
    """Build two roads that meet and one apart, and return a configuration of them."""
    nodes = "".join(
        f'<node id="{name}" x="{x}" y="{y}"/>'
        for name, x, y in (("a", 0, 0), ("b", 200, 0), ("c", 400, 0), ("d", 0, 300), ("e", 200, 300))
    )
    edges = "".join(
        EDGE.format(name, start, end, permissions)
        for name, start, end in (("e1", "a", "b"), ("e2", "b", "c"), ("apart", "d", "e"))
    )
    (folder / "n.nod.xml").write_text(f"<nodes>{nodes}</nodes>")
    (folder / "e.edg.xml").write_text(f"<edges>{edges}</edges>")
    import sumo

    netconvert = str(Path(sumo.SUMO_HOME) / "bin" / "netconvert")
    command = [netconvert, "-n", "n.nod.xml", "-e", "e.edg.xml"]
    subprocess.run([*command, "-o", "n.net.xml"], cwd=folder, check=True, capture_output=True)
    return configuration(folder)


def configuration(folder: Path, step: str = "0.1", net: str = "n.net.xml", extra: str = "") -> Path:
    path = folder / "town.sumocfg"
    path.write_text(
        f'<configuration><input><net-file value="{net}"/>{extra}</input>'
        f'<time><end value="30"/><step-length value="{step}"/></time></configuration>'
    )
    return path


def test_an_unknown_scenario_is_answered_by_those_that_exist(capsys: pytest.CaptureFixture[str]) -> None:
    assert "midblock_zebra" in refused(capsys, "run", "midblock_zebro")


@pytest.mark.parametrize("file", ["town.sumocfg", "people.rou.xml"])
def test_an_entity_from_another_file_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str
) -> None:
    network(tmp_path)
    (tmp_path / "people.rou.xml").write_text("<routes><!-- nobody --></routes>")
    path = configuration(tmp_path, extra='<route-files value="people.rou.xml"/>')
    declared = '<!DOCTYPE any [<!ENTITY other SYSTEM "/etc/hostname">]>'
    text = (tmp_path / file).read_text()
    for kind, said in ((declared, "without external entities"), ('<!DOCTYPE any SYSTEM "a.dtd">', "&other;")):
        (tmp_path / file).write_text(kind + text.replace("</", "&other;</", 1))
        for words in (["run", str(path), "--ego-route", "e1 e2"], ["inspect", str(path)]):
            line = refused(capsys, *words)
            assert file in line
            assert said in line


def test_an_unknown_controller_is_answered_by_those_that_exist(capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, "run", "midblock_zebra", "--controller", "vo_mcp")
    assert "vo_mcp" in line
    assert "vo_mpc" in line


def test_an_unknown_parameter_is_answered_by_those_of_scenario_and_controller(
    capsys: pytest.CaptureFixture[str],
) -> None:
    line = refused(capsys, "run", "midblock_zebra", "--set", "pedestrians_per_our=600")
    assert "did you mean 'pedestrians_per_hour'?" in line
    assert "horizon" in line or "solver" in line


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("pedestrians_per_hour=many", "number"),
        ("vehicles_per_hour=-1", "at least 0"),
        ("step_s=2", "at most 1"),
        ("step_s=0.01", "0.05"),
        ("actuation=teleport", "hybrid"),
        ("steps=many", "whole number"),
        ("pedestrians_per_hour", "key=value"),
    ],
)
def test_a_value_that_is_not_possible_is_refused_with_what_is(
    capsys: pytest.CaptureFixture[str], setting: str, words: str
) -> None:
    assert words in refused(capsys, "run", "midblock_zebra", "--set", setting)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--ego-share", "-0.1"], "above 0"),
        (["--ego-share", "0"], "record everybody"),
        (["--ego-share", "0.1", "--ego-vehicle", "x"], "exclude each other"),
        (["--duration-s", "-5"], "--duration-s"),
        (["--duration-s", "soon"], "number"),
        (["--seed", "-1"], "--seed"),
        (["--actuation", "rocket"], "hybrid or move"),
        (["--no-such-flag"], "--no-such-flag"),
        ([], "midblock_zebra"),
    ],
)
def test_wrong_usage_is_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    scenario = "midblock_zebra" if arguments else "nowhere"
    assert words in refused(capsys, "run", scenario, *arguments)


def test_a_folder_with_something_in_it_is_never_written_to(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "mine.txt").write_text("mine")
    line = refused(capsys, "run", "midblock_zebra", "--out", "results")
    assert "results" in line
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["mine.txt"]
    assert "expected a folder" in refused(capsys, "run", "midblock_zebra", "--out", "results/mine.txt")


def test_a_missing_or_broken_configuration_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert "gone.sumocfg" in refused(capsys, "run", "gone.sumocfg", "--ego-share", "0.1")
    (tmp_path / "broken.sumocfg").write_text("<configuration><input>")
    assert "broken.sumocfg" in refused(capsys, "run", "broken.sumocfg", "--ego-share", "0.1")
    configuration(tmp_path, net="gone.net.xml")
    assert "gone.net.xml" in refused(capsys, "run", "town.sumocfg", "--ego-share", "0.1")
    (tmp_path / "n.net.xml").write_text("<net><edge id=")
    configuration(tmp_path)
    assert "n.net.xml" in refused(capsys, "run", "town.sumocfg", "--ego-share", "0.1")


@pytest.mark.sumo
def test_a_route_an_ego_or_a_step_that_cannot_be_is_refused_and_leaves_no_folder(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    network(tmp_path)
    assert "no ego" in refused(capsys, "run", "town.sumocfg")
    assert "e9" in refused(capsys, "run", "town.sumocfg", "--ego-route", "e1 e9")
    line = refused(capsys, "run", "town.sumocfg", "--ego-route", "e1 apart")
    assert "e1" in line
    assert "apart" in line
    assert "nobody" in refused(capsys, "run", "town.sumocfg", "--ego-vehicle", "nobody")
    assert "0 passenger cars departed" in refused(capsys, "run", "town.sumocfg", "--ego-share", "0.5")
    configuration(tmp_path, step="2")
    assert "step-length" in refused(capsys, "run", "town.sumocfg", "--ego-route", "e1 e2")
    assert not list(tmp_path.glob("runs/*"))


@pytest.mark.sumo
def test_a_network_without_cars_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    network(tmp_path, permissions='allow="pedestrian"')
    line = refused(capsys, "run", "town.sumocfg", "--ego-route", "e1 e2")
    assert "passenger" in line


@pytest.mark.sumo
def test_an_ego_that_finds_no_place_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    network(tmp_path)
    parked = "".join(
        f'<vehicle id="v{i}" depart="0" departPos="{5 + 6 * i}" departSpeed="0"><route edges="e1 e2"/>'
        f'<stop lane="e1_0" endPos="{5.5 + 6 * i}" duration="900"/></vehicle>'
        for i in range(33)
    )
    (tmp_path / "full.rou.xml").write_text(f"<routes>{parked}</routes>")
    configuration(tmp_path, extra='<route-files value="full.rou.xml"/>')
    line = refused(capsys, "run", "town.sumocfg", "--ego-route", "e1 e2", "--set", "duration_s=90")
    assert "ego" in line
    assert not list(tmp_path.glob("runs/*"))


@pytest.mark.long
@pytest.mark.sumo
def test_a_run_that_goes_wrong_after_its_first_step_keeps_its_files_and_exits_with_3(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    network(tmp_path)
    # A vehicle on a route that does not exist is found when SUMO reads that far.
    late = '<vehicle id="bad" depart="28"><route edges="e1 apart"/></vehicle>'
    (tmp_path / "late.rou.xml").write_text(f"<routes>{late}</routes>")
    configuration(tmp_path, extra='<route-files value="late.rou.xml"/><route-steps value="20"/>')
    arguments = ("--ego-route", "e1 e2", "--controller", "constant_speed", "--set", "speed_mps=1")
    code = main(["run", "town.sumocfg", *arguments, "--duration-s", "30", "--out", "out"])
    captured = capsys.readouterr()
    assert code == 3, captured.err
    assert "invalid" in captured.err
    description = json.loads((tmp_path / "out/run.json").read_text())
    assert description["valid"] is False
    assert "bad" in description["invalid_reason"]
    assert (tmp_path / "out/egos.parquet").stat().st_size > 0


@pytest.mark.parametrize("arguments", [[], ["003", "--out", "results"], ["--help"]])
def test_the_command_of_earlier_versions_says_where_the_papers_experiments_are(
    capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    assert "make papers" in refused(capsys, "papers", *arguments)
    assert main(["--help"]) == 0
    assert "papers" not in capsys.readouterr().out


def test_help_shows_examples_and_exit_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--help"]) == 0
    text = capsys.readouterr().out
    assert 'cosim run town.sumocfg --ego-route "e1 e2 e3"' in text
    assert "Exit codes: 0 success, 2 bad input, 3" in text


def test_variants_in_the_help_of_compare_have_parameters_that_exist(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["compare", "--help"]) == 0
    found = re.findall(r'"(\w+) (\w+)=', capsys.readouterr().out)
    assert found
    for controller, key in found:
        assert key in inventory.controller_parameters(controller)


@pytest.mark.parametrize(
    ("kind", "name"),
    [("scenarios", "midblock_zebra"), ("controllers", "vo_mpc"), ("metrics", "time_to_collision")],
)
def test_what_exists_is_listed(capsys: pytest.CaptureFixture[str], kind: str, name: str) -> None:
    assert main(["list", kind]) == 0
    assert name in capsys.readouterr().out


def test_the_settings_of_a_scenario_are_listed_with_defaults_and_choices(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["list", "scenarios"]) == 0
    words = capsys.readouterr().out.split()
    assert "pedestrians_per_hour=200.0" in words
    assert "turn=right" in words
    assert "(right|straight|left)" in words
    assert "(hybrid|move)" in words


def test_help_loads_neither_numpy_nor_a_simulator() -> None:
    code = (
        "import sys; from cosim.cli import main; main(['--help']);"
        "sys.exit(bool({'numpy', 'libsumo', 'traci'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=False, env=source_environment()
    )
    assert done.returncode == 0


def test_debug_adds_the_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "nowhere", "--debug"]) == 2
    assert "Traceback" in capsys.readouterr().err


def test_folders_that_cannot_be_analysed_are_named_each(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "empty").mkdir()
    assert main(["analyse", "gone", "empty"]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 3
    assert "gone" in lines[0]
    assert "empty" in lines[1]
    assert "2 of 2 folders not analysed: gone, empty" in lines[2]


def test_a_trajectory_file_for_ssam_is_written_on_request(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", [Ego(line(-21.2, 0, 10, 0))], [Person(line(32.5, -4, 0, 1.25))])
    assert main(["analyse", str(folder)]) == 0
    assert not (folder / "run.trj").exists()
    assert main(["analyse", str(folder), "--ssam"]) == 0
    assert (folder / "run.trj").stat().st_size > 1000
    assert "ego" in (folder / "ssam_id_map.csv").read_text(encoding="utf-8")


def test_an_unknown_threshold_or_conformance_case_is_answered_by_those_that_exist(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert "severity_ttc" in refused(capsys, "analyse", "gone", "--set", "severity_ttc=1.2")
    assert "for instance severity_ttc_serious_s=1.2" in refused(
        capsys, "analyse", "gone", "--set", "severity_ttc"
    )
    assert "blind_step" in refused(capsys, "conformance", "no_such_case")


def test_options_of_the_other_kind_of_conformance_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, "conformance", "route", "--set", "margin_m=1")
    assert "--set margin_m=1 belongs to a controller" in line
    line = refused(capsys, "conformance", "--controller", "aeb", "--list")
    assert "--list lists the cases of the coupling" in line


@pytest.mark.sumo
def test_the_conformance_table_is_printed_and_written(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    key = "route"
    assert main(["conformance", key, "--out", "table.md"]) == 0
    printed = capsys.readouterr().out
    assert "1 of 1 cases green" in printed
    assert "table: table.md" in printed
    text = (tmp_path / "table.md").read_text()
    assert f"\n| {key} | " in text
    assert "1 of 1 cases green" in text


def test_a_conformance_table_that_cannot_be_written_is_told_before_the_cases_run(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert "gone/table.md" in refused(capsys, "conformance", "--out", "gone/table.md")
