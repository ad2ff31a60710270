"""Batches with SUMO, as a user starts them: whole, resumed, refused, and the same however they are run."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from cosim.batches.batch import BatchRequest
from cosim.processes import cores
from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.search.estimate import EstimateRequest
from cosim.search.search import FalsifyRequest
from tests.cosim.batches.studies import SHORT, batch, lasting, refused, rows, runs, write_study
from tests.cosim.cli.test_cli import network

pytestmark = pytest.mark.sumo

BUSY = {"warmup_s": 5, "duration_s": 36, "pedestrians_per_hour": 1200, "vehicles_per_hour": 200}
"""Long enough for an ego to meet somebody."""


@pytest.mark.long
def test_a_study_is_run_once_and_its_tables_say_so(tmp_path: Path) -> None:
    study = write_study(tmp_path, controllers=["sumo", "constant_speed"], set={**SHORT, "speed_mps": 8.0})
    done = batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)
    assert "4 of 4 runs finished, 0 failed" in done.stdout
    out = tmp_path / "out"
    assert len(runs(out)) == 4
    assert {row["run_id"] for row in rows(out / "runs.csv")} == {
        json.loads((out / "runs" / name / "run.json").read_text())["run_id"] for name in runs(out)
    }
    assert {row["metric"] for row in rows(out / "comparisons.csv")} >= {"ego_delay_mean_s"}
    assert rows(out / "failed.csv") == []
    assert not (out / "work").exists()
    before = {path: path.stat().st_mtime_ns for path in (out / "runs").rglob("*")}
    again = batch(study, "--out", "out", folder=tmp_path)
    assert "4 of 4 runs finished" in again.stdout
    assert {path: path.stat().st_mtime_ns for path in (out / "runs").rglob("*")} == before


def test_as_many_runs_as_there_are_cores_are_made_at_once_unless_it_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert cores() == (len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count())
    for module in ("batches.batch", "search.search", "search.estimate"):
        monkeypatch.setattr(f"cosim.{module}.cores", lambda: 7)
    out, study = Path("out"), Path("study.toml")
    searches = (FalsifyRequest("road", "aeb"), EstimateRequest("road", "aeb"))
    assert BatchRequest(study, out).processes == 7
    assert BatchRequest(study, out, jobs=3).processes == 3
    for one in searches:
        assert one.where.processes == 7
        assert replace(one, jobs=3).where.processes == 3


@pytest.mark.long
def test_a_run_of_a_batch_is_the_run_that_its_command_makes(tmp_path: Path) -> None:
    import shlex

    from cosim.cli import main

    study = write_study(tmp_path, controllers=["constant_speed"], seeds="3")
    batch(study, "--out", "out", folder=tmp_path)
    (name,) = runs(tmp_path / "out")
    made = tmp_path / "out" / "runs" / name
    line = shlex.split(json.loads((made / "job.json").read_text())["command"])
    assert main([*line[1:], "--out", str(tmp_path / "single")]) == 0
    for path in (tmp_path / "single").iterdir():
        if path.name not in ("run.json", "timing.parquet", "runs.csv", "files.json"):
            assert path.read_bytes() == (made / path.name).read_bytes(), path.name
    first, second = (json.loads((one / "run.json").read_text()) for one in (tmp_path / "single", made))
    assert first["run_id"] == second["run_id"]


def rows_of_one_process_and_of_two(folder: Path, settings: Mapping[str, float]) -> Path:
    """Compare the tables of a batch made by one process and by two, and return the folder of one of them."""
    study = write_study(folder, controllers=["sumo", "aeb"], set=settings, seeds="1-2")
    for jobs in (1, 2):
        batch(study, "--out", f"out{jobs}", "--jobs", jobs, folder=folder)
    assert lasting(folder / "out1") == lasting(folder / "out2")
    return folder / "out1"


@pytest.mark.long
def test_the_same_rows_come_from_one_process_and_from_two(tmp_path: Path) -> None:
    assert len(rows(rows_of_one_process_and_of_two(tmp_path, SHORT) / "runs.csv")) == 4


@pytest.mark.slow
def test_the_same_rows_of_encounters_come_from_one_process_and_from_two(tmp_path: Path) -> None:
    assert len(rows(rows_of_one_process_and_of_two(tmp_path, BUSY) / "encounters.csv")) > 0


def traffic(controller: str, seed: int) -> dict[str, object]:
    """Return where everybody is after the warm-up of a run."""
    import libsumo

    settings = {"warmup_s": "60", "duration_s": "70"}
    composition = compose(RunRequest("midblock_zebra", controller, seed, settings))
    try:
        composition.world.sense()
        return {
            name: (kind.getPosition(name), kind.getSpeed(name))
            for kind in (libsumo.vehicle, libsumo.person)
            for name in kind.getIDList()
        }
    finally:
        composition.close()


@pytest.mark.long
def test_one_seed_gives_every_controller_the_same_traffic_and_pedestrians() -> None:
    first = traffic("sumo", 1)
    assert len(first) > 20
    assert traffic("vo_mpc", 1) == traffic("aeb", 1) == first
    assert traffic("sumo", 2) != first


@pytest.mark.long
def test_recordings_are_dropped_on_request_and_the_numbers_are_the_same(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1")
    batch(study, "--out", "whole", folder=tmp_path)
    batch(study, "--out", "numbers", "--drop-recordings", folder=tmp_path)
    (name,) = runs(tmp_path / "numbers")
    assert sorted(path.name for path in (tmp_path / "numbers" / "runs" / name).iterdir()) == [
        *(
            "config.json",
            "encounters.csv",
            "files.json",
            "job.json",
            "run.json",
            "runs.csv",
            "vehicle_conflicts.csv",
            "vehicle_overlaps.csv",
        ),
    ]
    assert lasting(tmp_path / "whole") == lasting(tmp_path / "numbers")


@pytest.mark.long
def test_a_dry_run_shows_the_matrix_and_the_time_and_writes_nothing(tmp_path: Path) -> None:
    study = write_study(tmp_path, controllers=["sumo", "aeb"], vary={"vehicles_per_hour": [100, 200]})
    shown = batch(study, "--out", "out", "--dry-run", "--jobs", 2, folder=tmp_path).stdout
    assert "vehicles_per_hour=200" in shown
    assert "8 runs, 0 finished, 8 missing" in shown
    assert "a rough figure" in shown
    assert not (tmp_path / "out").exists()
    small = write_study(tmp_path / "small", controllers=["sumo"], seeds="1")
    batch(small, "--out", "out", folder=tmp_path)
    large = write_study(tmp_path / "large", controllers=["sumo"], seeds="1-9")
    shown = batch(large, "--out", "out", "--dry-run", folder=tmp_path).stdout
    assert "9 runs, 1 finished, 8 missing" in shown
    assert "from the 1 finished runs of this study" in shown
    assert len(runs(tmp_path / "out")) == 1


def test_wrong_usage_is_one_line(tmp_path: Path) -> None:
    study = write_study(tmp_path)
    assert "gone.toml" in refused("gone.toml", folder=tmp_path)
    assert "use either --jobs or --scheduler" in refused(
        study, "--jobs", 2, "--scheduler", "tcp://127.0.0.1:1", folder=tmp_path
    )
    assert "--jobs" in refused(study, "--jobs", 0, folder=tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").touch()
    assert "other files" in refused(study, "--out", "mine", folder=tmp_path)


@pytest.mark.long
def test_an_edited_network_and_another_study_are_noticed_and_named(tmp_path: Path) -> None:
    town = network(tmp_path)
    keys = {"scenarios": [town.name], "controllers": ["constant_speed"]}
    settings = {"ego_route": "e1 e2", "duration_s": 8.0, "speed_mps": 5.0}
    study = write_study(tmp_path, **keys, seeds="1", set=settings)
    batch(study, "--out", "out", folder=tmp_path)
    (name,) = runs(tmp_path / "out")
    edited = (tmp_path / "n.net.xml").read_text().replace('speed="13.90"', 'speed="12.90"')
    assert edited != (tmp_path / "n.net.xml").read_text()
    (tmp_path / "n.net.xml").write_text(edited)
    write_study(tmp_path, **keys, seeds="1-2", set=settings)
    line = refused(study, "--out", "out", folder=tmp_path)
    assert name in line
    assert "input file n.net.xml has another content" in line
    write_study(tmp_path, **keys, seeds="1-2", set={**settings, "speed_mps": 6.0})
    assert "belongs to another study" in refused(study, "--out", "out", folder=tmp_path)
    assert runs(tmp_path / "out") == [name]


@pytest.mark.long
def test_without_out_the_study_is_kept_below_runs(tmp_path: Path) -> None:
    batch(write_study(tmp_path, seeds="1"), folder=tmp_path)
    assert len(runs(tmp_path / "runs" / "study")) == 1
