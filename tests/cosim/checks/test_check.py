"""``cosim check`` as its users start it, with SUMO."""

from __future__ import annotations

import csv
import json
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest

from analysis.files import write_json
from analysis.sealing import seal
from cosim.cli import main
from tests.cosim.batches import unruly
from tests.cosim.batches.studies import write_study
from tests.cosim.cli.commands import ended
from tests.cosim.cli.test_cli import refused

pytestmark = pytest.mark.sumo

SHORT = ("--set", "duration_s=8", "--set", "warmup_s=2", "--jobs", "1")
CRITERION = '[[criteria]]\nscope = "run"\nmetric = "{0}"\noperator = "{1}"\nthreshold = {2}\n'


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)


def check(
    *arguments: object, code: int, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a check to its end, which must have this exit code."""
    return ended("check", *arguments, code=code, environment=environment)


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "criteria.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def criteria(metric: str, sign: str, threshold: object, name: str = "criteria.toml") -> Path:
    path = Path(name)
    path.write_text(CRITERION.format(metric, sign, threshold))
    return path


def test_a_built_in_scenario_passes_and_the_same_command_makes_no_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import frictionless  # it takes long to load, and every worker collects this file

    summary = tmp_path / "summary.md"
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    arguments = ["midblock_zebra", *SHORT, "--out", "out", "--junit", "out/junit.xml"]
    done = check(*arguments, code=0)
    assert "passed: " in done.stdout
    assert summary.read_text().startswith("### cosim check passed: ")
    found = rows(Path("out"))
    assert {row["status"] for row in found} <= {"pass", "undefined"}
    assert {row["criterion_id"] for row in found if row["scope"] == "run"} > {"valid", "no deadlock"}
    report = frictionless.validate("out/datapackage.json")
    assert report.valid, report.flatten(["type", "note"])
    root = ElementTree.parse("out/junit.xml").getroot()
    assert (root.get("failures"), root.get("errors"), root.get("tests")) == ("0", "0", str(len(found)))
    run = next(Path("out/midblock_zebra/runs").iterdir()) / "run.json"
    before, content = run.stat().st_mtime_ns, Path("out/criteria.csv").read_bytes()
    assert main(["report", "out"]) == 0  # what it writes there is in nobody's way
    check(*arguments, code=0)
    assert run.stat().st_mtime_ns == before
    assert Path("out/criteria.csv").read_bytes() == content


@pytest.mark.long
def test_what_a_check_of_own_files_made_is_judged_again_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = tmp_path / "there"
    (there / "mine").mkdir(parents=True)
    (there / "mine" / "scenario.toml").write_text(
        'description = "a"\nduration_s = 130.0\nbase = "midblock_zebra"\n'
        + CRITERION.format("n_collisions", "==", 0)
    )
    (there / "slow.py").write_text(
        "def build():\n    from controllers.outside.functions import FromFunction\n\n"
        "    return FromFunction(lambda perception: 3.0 - perception.ego.speed)\n"
    )
    study = write_study(there, scenarios=["mine"], controllers=["./slow.py"], seeds="1")
    monkeypatch.chdir(there)
    check(study, "--controller", "./slow.py", "--out", "out", "--jobs", "1", code=0)
    made = rows(Path("out"))
    monkeypatch.chdir(tmp_path)
    check("--results", "there/out", code=0)
    found = rows(Path("there/out"))
    assert [row["criterion_id"] for row in found] == ["valid", "n_collisions == 0"]
    assert [row["status"] for row in found] == [row["status"] for row in made]


def test_a_controller_that_does_nothing_fails_and_the_file_says_how_to_see_it_again() -> None:
    out = Path("out")
    done = check(
        *("suite:fmvss127", "--filter", "crossing_right_25_[13]0kmh", "--controller", "constant_speed"),
        *("--out", out, "--junit", "junit.xml", "--jobs", "1"),
        code=1,
    )
    assert "impact at 30.0 km/h" in done.stderr
    failures = list(ElementTree.parse("junit.xml").getroot().iter("failure"))
    assert len(failures) == 2
    text = str(failures[1].text)
    assert "expected no contact" in text
    assert "seed 1" in text
    (again,) = (line.removeprefix("again: ") for line in text.splitlines() if line.startswith("again: "))
    words = shlex.split(again)
    assert words[0] == "cosim"
    assert main([*words[1:], "--out", "again"]) == 0
    (row,) = [row for row in rows(out) if row["criterion_id"].endswith("30kmh") and row["scope"] == "case"]
    with open("again/encounters.csv", newline="", encoding="utf-8") as file:
        speeds = [each["impact_speed_kmh"] for each in csv.DictReader(file) if each["collision"] == "1"]
    assert float(speeds[0]) == pytest.approx(float(row["value"]), abs=0.05)


@pytest.mark.long
def test_cases_of_a_protocol_pass_with_a_controller_that_brakes() -> None:
    check("suite:fmvss127/crossing_right_25_30kmh", "--out", "out", "--jobs", "1", code=0)
    (row,) = [row for row in rows(Path("out")) if row["scope"] == "case"]
    assert (row["status"], row["metric"], row["value"]) == ("pass", "impact_speed_kmh", "")


@pytest.mark.slow
def test_a_run_that_takes_too_long_is_invalid(tmp_path: Path) -> None:
    environment = unruly.install(tmp_path / "plugin")
    arguments = ("midblock_zebra", *SHORT, "--controller", "unruly", "--set", "behaviour=hang")
    done = check(
        *(*arguments, "--run-timeout-s", "5", "--out", "out", "--junit", "junit.xml"),
        code=3,
        environment=environment,
    )
    assert "still running after run_timeout_s = 5 s" in done.stderr
    errors = list(ElementTree.parse("junit.xml").getroot().iter("error"))
    assert errors
    assert all("still running after run_timeout_s = 5 s" in str(error.get("message")) for error in errors)


@pytest.mark.long
def test_an_invalid_run_weighs_more_than_a_criterion_that_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unruly.use(tmp_path / "plugin", monkeypatch)
    impossible = criteria("ego_mean_speed_mps", "<", -1)
    arguments = ["midblock_zebra", *SHORT, "--criteria", impossible, "--controller", "sumo"]
    both = [*arguments, "--controller", "unruly", "--set", "behaviour=kill", "--out", "both"]
    done = check(*both, code=3)
    statuses = {row["controller"]: row["status"] for row in rows(Path("both")) if row["metric"] != "valid"}
    assert statuses == {"sumo": "fail", "unruly": "invalid"}
    assert "SIGKILL" in done.stderr
    check(*arguments, "--out", "alone", code=1)


@pytest.mark.long
def test_a_teleported_ego_makes_a_run_invalid() -> None:
    arguments = ["midblock_zebra", *SHORT, "--controller", "sumo", "--out", "out"]
    check(*arguments, code=0)
    (path,) = Path("out/midblock_zebra/runs").glob("*/run.json")
    reason = "SUMO teleported 1 egos"
    # What a run leaves behind when SUMO teleports an ego, whose occurrence cannot be ordered.
    description = json.loads(path.read_text())
    seal(path.parent, [write_json(path, {**description, "valid": False, "invalid_reason": reason})])
    done = check(*arguments, code=3)
    assert reason in done.stderr
    assert {row["status"] for row in rows(Path("out"))} == {"invalid"}


@pytest.mark.long
def test_statistics_of_a_configuration_are_those_of_the_study() -> None:
    Path("study").mkdir()
    table = (
        '[[criteria]]\nscope = "configuration"\nmetric = "ego_delay_mean_s"\nstatistic = "mean"\n'
        'operator = "<"\nthreshold = 1e6\n[[criteria]]\nscope = "configuration"\nmetric = "collision_share"\n'
        'statistic = "upper_95"\noperator = "<"\nthreshold = 1e-6\nallow_undefined = true\n'
    )
    study = write_study(Path("study"))
    study.write_text(study.read_text() + table)
    check(study, "--out", "out", "--jobs", "1", "--set", "duration_s=20", code=0)
    (delay, share) = [row for row in rows(Path("out")) if row["scope"] == "configuration"]
    with open("out/study/configs.csv", newline="", encoding="utf-8") as file:
        means = {row["metric"]: row["mean"] for row in csv.DictReader(file) if row["kind"] == "mean"}
    assert delay["value"] == means["ego_delay_mean_s"] != ""
    assert (delay["n_runs"], share["status"]) == ("2", "undefined")


@pytest.mark.slow
def test_code_that_got_worse_fails_against_the_runs_of_before(tmp_path: Path) -> None:
    environment = unruly.install(tmp_path / "plugin")
    arguments = ["midblock_zebra", "--set", "duration_s=12", "--set", "warmup_s=2", "--jobs", "2"]
    arguments += ["--controller", "unruly", "--seeds", "1-4"]
    check(*arguments, "--out", "then", environment=environment, code=0)
    check(*arguments, "--out", "same", "--baseline", "then", environment=environment, code=0)
    plugin = tmp_path / "plugin" / "unruly.py"
    code = plugin.read_text()
    for old, new in (
        ("at_s: float = 3.0)", "at_s: float = 3.0, seed: int = 1)"),
        ("Unruly(behaviour, at_s)", "Unruly(behaviour, at_s, seed)"),
        (
            "at_s: float) -> None:",
            "at_s: float, seed: int) -> None:\n        self.slower = 1.0 + seed % 7 / 10",
        ),
        ("constant_command(0.0,", "constant_command(-self.slower,"),
    ):
        assert old in code
        code = code.replace(old, new)
    plugin.write_text(code)
    done = check(*arguments, "--out", "now", "--baseline", "then", environment=environment, code=1)
    assert "ego_delay_mean_s" in done.stderr
    assert "worse at level 0.05" in done.stderr
    failed = {row["metric"] for row in rows(Path("now")) if row["status"] == "fail"}
    assert "ego_delay_mean_s" in failed
    assert failed <= {row["metric"] for row in rows(Path("now")) if row["scope"] == "baseline"}


@pytest.mark.long
def test_a_baseline_of_another_road_or_study_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["midblock_zebra", *SHORT, "--controller", "sumo", "--seeds", "1-2"]
    check(*arguments, "--out", "then", code=0)

    def told(*others: str) -> str:
        return refused(capsys, "check", *others, "--baseline", "then", "--out", "now")

    assert "belongs to another study" in told(*arguments[:-4], "--controller", "aeb")
    assert "belongs to another study" in told("midblock_unmarked", *arguments[1:])
    assert "belongs to another study" in told(*arguments, "--set", "pedestrians_per_hour=200")
    assert "at least 2 seeds in common" in told(*arguments[:-1], "2-3")
    runs = [str(path.parent) for path in Path("then").rglob("run.json")]
    assert main(["analyse", *runs, "--set", "hard_brake_mps2=2"]) == 0
    assert "was judged with other thresholds than these runs" in refused(
        capsys, "check", *arguments, "--baseline", "then", "--out", "later"
    )
    assert main(["analyse", *runs]) == 0
    for path in Path("then").rglob("run.json"):
        description = json.loads(path.read_text())
        changed = {**description, "inputs": {**description["inputs"], "network": "0"}}
        seal(path.parent, [write_json(path, changed)])
    assert "the input network had another content" in told(*arguments)
    assert not Path("now").exists()
