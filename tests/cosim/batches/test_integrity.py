"""Files of finished runs that were altered or lost: noticed by everything that reads them, and named."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from analysis.manifest import MANIFEST
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.cosim.batches import unruly
from tests.cosim.batches.studies import batch, lasting, rows, runs, write_study
from tests.cosim.cli.commands import ended

pytestmark = pytest.mark.sumo

ROOT = Path(__file__).resolve().parents[3]
BUSY = {"warmup_s": 5, "duration_s": 36, "pedestrians_per_hour": 1200, "vehicles_per_hour": 200}
"""Long enough for an ego to meet somebody."""
FAILING = {**BUSY, "behaviour": "raise", "at_s": 8}


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of four finished runs and a failed one."""
    folder = tmp_path_factory.mktemp("study")
    with pytest.MonkeyPatch.context() as patch:
        unruly.use(folder / "plugin", patch)
        failing = write_study(folder, controllers=["unruly"], seeds="1", set=FAILING)
        batch(failing, "--out", "out", "--jobs", 1, code=3, folder=folder)
    study = write_study(folder, controllers=["sumo", "aeb"], set=BUSY)
    batch(study, "--out", "out", "--jobs", 2, folder=folder)
    return folder


@pytest.fixture
def study(finished: Path, tmp_path: Path) -> Path:
    """A copy of it to damage, with the study file."""
    return shutil.copytree(finished, tmp_path / "study")


def flip(path: Path) -> None:
    """Turn one bit in the middle of a file."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def cut(path: Path) -> None:
    """Take the last byte away."""
    path.write_bytes(path.read_bytes()[:-1])


def without_a_row(path: Path) -> None:
    """Remove the last row of a table."""
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:-1]))


def run_of(study: Path, controller: str, seed: int) -> Path:
    (folder,) = (study / "out" / "runs").glob(f"*-{controller}-seed{seed}-*")
    return folder


def told(error: str) -> list[str]:
    return [line for line in error.splitlines() if line.startswith("cosim: ")]


@pytest.mark.parametrize("damage", [flip, cut, Path.unlink])
def test_verify_names_every_file_that_was_altered_or_lost(
    study: Path, damage: Callable[[Path], None]
) -> None:
    run = run_of(study, "aeb", 1)
    names = {path.name for path in run.iterdir()}
    assert names >= {"run.json", "job.json", "map.json", "egos.parquet", "encounters.csv", MANIFEST}
    for name in sorted(names):
        before = (run / name).read_bytes()
        damage(run / name)
        (line,) = told(ended("verify", "out", code=3, folder=study).stderr)
        assert f"{run.relative_to(study)}/{name}: " in line
        assert "makes it again" in line or "make the run again" in line
        (run / name).write_bytes(before)
    done = ended("verify", "out", folder=study)
    assert "5 runs verified, 0 files damaged" in done.stdout
    assert done.stderr == ""


def test_verify_takes_a_run_and_says_what_was_expected_of_other_folders(study: Path, tmp_path: Path) -> None:
    run = run_of(study, "sumo", 1)
    assert "1 runs verified, 0 files damaged" in ended("verify", run).stdout
    assert "no such folder" in ended("verify", tmp_path / "nothing", code=2).stderr
    (tmp_path / "empty").mkdir()
    assert "contains no runs; expected" in ended("verify", tmp_path / "empty", code=2).stderr


@pytest.mark.long
def test_a_batch_goes_on_without_damaged_runs_and_names_them(study: Path) -> None:
    undisturbed = lasting(study / "out")
    recording = run_of(study, "sumo", 1) / "neighbours.parquet"
    flip(recording)
    encounters = run_of(study, "aeb", 1) / "encounters.csv"
    count = len(rows(encounters))
    assert count > 0
    without_a_row(encounters)
    note = run_of(study, "aeb", 2) / "job.json"
    note.write_text("[]")
    (failure,) = (study / "out" / "failed").glob("*/failure.json")
    reason = failure.read_text()
    failure.write_text('{"run": ')

    done = batch(study / "study.toml", "--out", "out", code=3, folder=study)
    assert "1 of 4 runs finished, 0 failed, 4 damaged; tables: out/*.csv" in done.stdout
    lines = told(done.stderr)
    assert len(lines) == 4
    for path in (recording, encounters, note, failure):
        (line,) = (each for each in lines if str(path.relative_to(study)) in each)
        assert "make the run again" in line or "makes it again" in line or "makes the run again" in line
    assert f"{count - 1} rows, {count} rows were written" in done.stderr
    (row,) = (each for each in rows(study / "out" / "runs.csv") if each["valid"] == "1")
    assert (row["controller"], row["seed"]) == ("sumo", "2")
    (row,) = rows(study / "out" / "failed.csv")
    assert row["run"] == failure.parent.name
    assert "failure.json: cannot be read" in row["reason"]

    ended("analyse", encounters.parent)
    for path in (recording, note):
        shutil.rmtree(path.parent)
    failure.write_text(reason)
    assert (
        "4 of 4 runs finished, 0 failed; " in batch(study / "study.toml", "--out", "out", folder=study).stdout
    )
    assert lasting(study / "out") == undisturbed


@pytest.mark.long
def test_the_tables_of_a_study_are_verified_too(study: Path) -> None:
    out = study / "out"
    tables = sorted(path.name for path in out.glob("*.csv"))
    assert tables == ["comparisons.csv", "configs.csv", "encounters.csv", "failed.csv", "runs.csv"]
    shutil.copytree(run_of(study, "aeb", 1), out / ".work" / "run")  # as of a batch at work
    flip(out / ".work" / "run" / "runs.csv")
    undisturbed = {name: (out / name).read_bytes() for name in (*tables, "datapackage.json", MANIFEST)}
    for name in undisturbed:
        flip(out / name)
        (line,) = told(ended("verify", "out", code=3, folder=study).stderr)
        assert f"out/{name}: " in line
        assert "the batch or check, repeated, writes it again" in line
        (out / name).write_bytes(undisturbed[name])
    flip(out / "configs.csv")
    flip(out / "datapackage.json")
    ended("report", "out", folder=study)  # from the runs
    assert "configs.csv" in {path.name for path in (out / "report_data").glob("*.csv")}
    flip(out / "failed.csv")
    assert "out/failed.csv: has another content" in ended("report", "out", code=2, folder=study).stderr
    batch(study / "study.toml", "--out", "out", folder=study)
    assert {name: (out / name).read_bytes() for name in undisturbed} == undisturbed


@pytest.mark.long
def test_compare_and_report_go_on_without_a_damaged_run_and_name_it(study: Path) -> None:
    for name in ("encounters.csv", "run.json"):
        run = run_of(study, "aeb", 1)
        before = (run / name).read_bytes()
        (run / name).write_bytes(before.replace(b"1", b"2", 1))
        for words in (["compare", "out", "--base", "sumo", "--alt", "aeb"], ["report", "out"]):
            done = ended(*words, code=3, folder=study)
            (line,) = told(done.stderr)
            assert f"out/runs/{run.name}/{name}: has another content than it was written with" in line
        assert f"{run.name}/{name}: has another content" in (study / "out" / "report.html").read_text()
        (run / name).write_bytes(before)
    ended("compare", "out", "--base", "sumo", "--alt", "aeb", folder=study)


@pytest.mark.long
def test_a_report_names_a_recording_that_it_could_not_replay(study: Path) -> None:
    path = run_of(study, "aeb", 1) / "neighbours.parquet"
    flip(path)
    (line,) = told(ended("report", "out", code=3, folder=study).stderr)
    assert f"{path.relative_to(study)}: has another content than it was written with" in line
    path.unlink()
    (line,) = told(ended("report", "out", code=3, folder=study).stderr)
    assert f"{path.relative_to(study)}: is missing" in line


@pytest.mark.parametrize(
    "words", [["analyse"], ["plot"], ["replay", "--encounter", "1", "--out", "film.gif"]]
)
def test_commands_for_one_run_refuse_a_recording_that_was_altered(study: Path, words: list[str]) -> None:
    run = run_of(study, "aeb", 1)
    flip(run / "egos.parquet")
    before = {path.name: path.read_bytes() for path in run.iterdir()}
    (line,) = told(ended(words[0], run, *words[1:], code=2, folder=study).stderr)
    assert f"{run}/egos.parquet: has another content than it was written with; remove the folder" in line
    assert {path.name: path.read_bytes() for path in run.iterdir()} == before


def test_analysing_again_mends_tables_and_takes_down_what_it_wrote(study: Path) -> None:
    run = run_of(study, "aeb", 1)
    before = {path.name: path.read_bytes() for path in run.iterdir()}
    without_a_row(run / "encounters.csv")
    (line,) = told(ended("verify", run, code=3).stderr)
    assert f"cosim analyse {run} makes it again" in line
    ended("analyse", run)
    assert {path.name: path.read_bytes() for path in run.iterdir()} == before
    ended("analyse", run, "--ssam", "--set", "severity_ttc_serious_s=1.2")
    assert "0 files damaged" in ended("verify", run).stdout
    flip(run / "run.trj")
    assert f"{run}/run.trj: " in ended("verify", run, code=3).stderr


@pytest.mark.long
def test_folders_of_before_are_read_with_a_line_that_says_so(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.plots.animation.DOTS_PER_INCH", 20)
    said = "runs were made without hashes of their files; not verified: "
    for name in runs(study / "out"):
        run = study / "out" / "runs" / name
        (run / MANIFEST).unlink()
        description = json.loads((run / "run.json").read_text())
        del description["hashes"]
        (run / "run.json").write_text(json.dumps(description))
    compare = ["compare", "out", "--base", "sumo", "--alt", "aeb"]
    shutil.rmtree(study / "out" / "failed")
    commands = [compare, ["report", "out"], ["verify", "out"], ["batch", "study.toml", "--out", "out"]]
    for words in commands:
        assert ended(*words, folder=study).stdout.count(f"4 of 4 {said}") == 1
    # Of a second, as a film of it is.
    brief = write_run(
        study / "brief", [Ego(line(0.0, 0.0, 5.0, 0.0))], [Person(line(32.5, -5.0, 0.0, 0.9))], duration=1.0
    )
    assert not (brief / MANIFEST).exists()
    run = run_of(study, "aeb", 1)
    film = ("replay", brief, "--encounter", "1", "--out", "film.gif")
    for arguments in (("plot", run), film, ("analyse", run)):
        assert f"1 of 1 {said}" in ended(*arguments, folder=study).stdout
    assert "1 runs verified, 0 files damaged" in ended("verify", run).stdout
    assert f"3 of 4 {said}" in ended(*compare, folder=study).stdout


@pytest.mark.long
def test_the_time_that_hashes_take_of_a_batch_can_be_measured(study: Path) -> None:
    words = [sys.executable, str(ROOT / "benchmarks" / "verification.py"), str(study / "out" / "runs")]
    done = subprocess.run(words, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    heads, _, values = ([cell.strip() for cell in line.split("|")] for line in done.stdout.splitlines())
    row = dict(zip(heads, values, strict=True))
    assert row["runs"] == "4"
    assert float(row["share of the batch [%]"]) > 0.0
