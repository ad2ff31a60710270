"""Runs on a Dask cluster: a real scheduler and two real workers on this machine."""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
import tarfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from cosim.batches.dask_cluster import Cluster
from cosim.batches.job import Configuration
from cosim.batches.shipping import bundles, unpack, unpack_bundle
from cosim.batches.worker import Handling
from cosim.errors import InputError, SimulationError
from sumo_scenarios import library
from tests.cosim.batches import unruly
from tests.cosim.batches.studies import batch, lasting, refused, rows, runs, some_job, write_study
from tests.cosim.cli.commands import command, source_environment
from tests.cosim.cli.test_cli import network

NANNY, NO_NANNY = "--nanny", "--no-nanny"


@dataclass(frozen=True, slots=True)
class _Cluster:
    address: str
    scheduler: psutil.Process
    workers: tuple[psutil.Process, ...]


def _dask(*arguments: str, folder: Path, environment: dict[str, str]) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        cwd=folder,
        env={**source_environment(), **environment},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )


def _said(process: subprocess.Popen[str], pattern: str) -> str:
    """Wait until a process says something, and return the first group of it."""
    assert process.stderr is not None
    for line in process.stderr:
        if match := re.search(pattern, line):
            return match[1]
    raise AssertionError(f"ended without saying {pattern}")


@contextmanager
def cluster(folder: Path, environment: dict[str, str], protocol: str = "tcp") -> Iterator[_Cluster]:
    """Give a scheduler with two workers of one thread: one with Dask's watchman, one without."""
    folder.mkdir(parents=True, exist_ok=True)
    scheduler = _dask(
        *("scheduler", "--protocol", protocol, "--port", "0", "--host", "127.0.0.1", "--no-dashboard"),
        folder=folder,
        environment=environment,
    )
    started = [scheduler]
    try:
        address = _said(scheduler, r"Scheduler at:\s+(t\w+://\S+)")
        for watched in (NANNY, NO_NANNY):
            worker = _dask(
                *("worker", address, "--nthreads", "1", watched, "--no-dashboard"),
                folder=folder,
                environment=environment,
            )
            started.append(worker)
            _said(worker, r"(Starting established connection)")
        first, *others = (psutil.Process(one.pid) for one in started)
        yield _Cluster(address, first, tuple(others))
    finally:
        for one in started:
            for child in psutil.Process(one.pid).children(recursive=True) if one.poll() is None else []:
                child.kill()
            one.kill()
            one.wait()
            assert one.stderr is not None
            one.stderr.close()


def start(study: Path, out: str, there: _Cluster, count: int) -> subprocess.Popen[str]:
    """Start a batch and wait until so many of its runs are finished."""
    process = subprocess.Popen(
        command("batch", study, "--out", out, "--scheduler", there.address),
        cwd=study.parent,
        env=source_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    folder = study.parent / out
    deadline = time.monotonic() + 120.0
    while not (folder / "runs").is_dir() or len(runs(folder)) < count:
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


@pytest.mark.slow
@pytest.mark.sumo
@pytest.mark.parametrize("runs_in_all", [12, 4])  # 4 are handed out at once
def test_a_scheduler_that_goes_away_ends_the_batch_and_costs_no_finished_run(
    tmp_path: Path, runs_in_all: int
) -> None:
    study = write_study(tmp_path, seeds=f"1-{runs_in_all}", set={"warmup_s": 2, "duration_s": 40})
    with cluster(tmp_path / "cluster", {}) as there:
        process = start(study, "out", there, 1)
        there.scheduler.kill()
        stdout, stderr = process.communicate(timeout=120.0)
    assert process.returncode == 3, stderr
    assert f"the connection to the scheduler {there.address} is lost" in stderr
    assert "Traceback" not in stderr
    finished = len(runs(tmp_path / "out"))
    assert 1 <= finished < runs_in_all
    assert f"{finished} of {runs_in_all} runs finished, 0 failed" in stdout
    batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)


@pytest.mark.slow
@pytest.mark.sumo
def test_a_cluster_of_which_a_worker_is_killed_gives_the_same_rows(tmp_path: Path) -> None:
    network(tmp_path)
    study = write_study(
        tmp_path,
        scenarios=["town.sumocfg"],
        controllers=["sumo", "constant_speed"],
        seeds="1-8",
        set={"duration_s": 20, "ego_route": "e1 e2", "speed_mps": 5.0},
    )
    batch(study, "--out", "here", "--jobs", 2, folder=tmp_path)
    with cluster(tmp_path / "cluster", {}) as there:
        process = start(study, "there", there, 3)
        victim = there.workers[1]
        orphans = victim.children(recursive=True)
        assert orphans
        victim.kill()
        stdout, stderr = process.communicate(timeout=240.0)
        assert process.returncode == 0, stderr
        assert "16 of 16 runs finished, 0 failed" in stdout
        _, alive = psutil.wait_procs(orphans, timeout=10.0)
        assert not alive
        again = batch(study, "--out", "there", "--scheduler", there.address, folder=tmp_path)
        assert "16 of 16 runs finished" in again.stdout
    assert lasting(tmp_path / "there") == lasting(tmp_path / "here")
    assert {path.name for path in (tmp_path / "there" / "runs").rglob("*.parquet")} >= {"egos.parquet"}


@pytest.mark.slow
@pytest.mark.sumo
def test_a_run_that_crashes_or_hangs_there_does_not_take_the_worker_with_it(tmp_path: Path) -> None:
    environment = unruly.install(tmp_path / "plugin")
    study = write_study(
        tmp_path,
        controllers=["sumo", "unruly"],
        seeds="1-2",
        vary={"behaviour": ["none", "crash", "hang"]},
        run_timeout_s=10,
    )
    with cluster(tmp_path / "cluster", environment) as there:
        options = (study, "--out", "out", "--scheduler", there.address, "--drop-recordings")
        batch(*options, code=3, folder=tmp_path, environment=environment)
        assert all(one.is_running() for one in there.workers)
    assert len(runs(tmp_path / "out")) == 4
    failed = rows(tmp_path / "out" / "failed.csv")
    assert sorted(("SIGSEGV" in row["reason"], "run_timeout_s" in row["reason"]) for row in failed) == [
        (False, True),
        (False, True),
        (True, False),
        (True, False),
    ]
    assert not list((tmp_path / "out" / "runs").rglob("*.parquet"))


@pytest.mark.slow
def test_an_address_at_which_nobody_answers_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1")
    line = refused(study, "--out", "out", "--scheduler", "tcp://127.0.0.1:1", folder=tmp_path)
    assert "--scheduler tcp://127.0.0.1:1: no Dask scheduler answers there" in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("address", ["nonsense://", "tcp://", "nowhere"])
def test_what_is_no_address_is_refused(tmp_path: Path, address: str) -> None:
    with pytest.raises(InputError, match=f"--scheduler {address}: no Dask scheduler"):
        Cluster(address, tmp_path, [some_job().configuration], Handling(60.0))


@pytest.mark.slow
def test_workers_with_another_version_are_refused(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1")
    elsewhere = tmp_path / "elsewhere"
    (elsewhere / "numpy-0.1.dist-info").mkdir(parents=True)
    (elsewhere / "numpy-0.1.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: numpy\nVersion: 0.1\n"
    )
    path = f"{source_environment()['PYTHONPATH']}"
    with cluster(tmp_path / "cluster", {"PYTHONPATH": f"{elsewhere}:{path}"}) as there:
        line = refused(study, "--out", "out", "--scheduler", there.address, folder=tmp_path)
    assert "has numpy 0.1; expected" in line


def configuration_of(place: Path | str, **settings: str) -> Configuration:
    """Return a configuration of a scenario that is at this place."""
    return Configuration(str(place), str(place), "x", "sumo", tuple(settings.items()), (), ())


def test_an_own_configuration_travels_with_everything_it_is_made_of(tmp_path: Path) -> None:
    (tmp_path / "roads").mkdir()
    (one,) = bundles([configuration_of(network(tmp_path / "roads"))])
    there = library.load(unpack_bundle(one, tmp_path / "there"))
    assert there.name == "town"
    copied, original = (folder / "n.net.xml" for folder in (tmp_path / "there", tmp_path / "roads"))
    assert copied.read_bytes() == original.read_bytes()


@pytest.mark.parametrize("name", library.names())
def test_a_scenario_folder_travels_with_all_that_it_names(tmp_path: Path, name: str) -> None:
    shutil.copytree(library.LIBRARY, tmp_path / "here", ignore=shutil.ignore_patterns("*.py"))
    place = tmp_path / "here" / name
    (one,) = bundles([configuration_of(place)])
    scenario = library.load(unpack_bundle(one, tmp_path / "there"))
    assert scenario.name == name
    inputs = [
        library.prepare(each, 1, tmp_path / "work").inputs for each in (scenario, library.load(str(place)))
    ]
    assert inputs[0] == inputs[1]


def test_a_variant_of_a_built_in_scenario_travels_with_the_trajectory_that_it_names(tmp_path: Path) -> None:
    mine = tmp_path / "here" / "mine"
    mine.mkdir(parents=True)
    (mine / "walk.csv").write_text("time_s,x_m,y_m\n0,100,0\n5,100,7\n")
    (mine / library.DEFINITION).write_text(
        'description = "x"\nduration_s = 90.0\nbase = "jaywalk_arterial"\n'
        '[[pedestrians]]\nname = "a"\nkind = "trajectory"\nfile = "walk.csv"\n'
    )
    (one,) = bundles([configuration_of(mine)])
    library.load(unpack_bundle(one, tmp_path / "there"))
    files = {path.name for path in (tmp_path / "there").rglob("*") if path.is_file()}
    assert files == {library.DEFINITION, "walk.csv"}


def test_a_file_that_a_parameter_chooses_travels_with_each_of_its_values(tmp_path: Path) -> None:
    shutil.copytree(library.LIBRARY / "midblock_zebra", tmp_path / "here" / "mine")
    shutil.copytree(library.LIBRARY / "road_users", tmp_path / "here" / "road_users")
    definition = tmp_path / "here" / "mine" / "scenario.toml"
    text = definition.read_text().replace('routes = ["demand.rou.xml"]', 'routes = ["$load.rou.xml"]')
    assert "$load" in text
    definition.write_text(
        text + '\n[parameters.load]\ndefault = "light"\nchoices = ["light", "heavy"]\ndescription = "x"\n'
    )
    demand = definition.parent / "demand.rou.xml"
    for load in ("light", "heavy"):
        (definition.parent / f"{load}.rou.xml").write_text(demand.read_text())
    place = definition.parent
    (one,) = bundles([configuration_of(place, load=load) for load in ("light", "heavy")])
    unpack_bundle(one, tmp_path / "there")
    assert {path.name for path in (tmp_path / "there").rglob("*.rou.xml")} == {
        *("light.rou.xml", "heavy.rou.xml"),
    }


def test_a_built_in_scenario_need_not_travel() -> None:
    assert bundles([configuration_of("midblock_zebra")]) == ()


@pytest.mark.parametrize("name", ["../outside.txt", "/outside.txt"])
def test_an_archive_that_would_write_elsewhere_is_refused(tmp_path: Path, name: str) -> None:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        archive.addfile(tarfile.TarInfo(name))
    with pytest.raises(SimulationError, match="not one of ours"):
        unpack(buffer.getvalue(), tmp_path / "there")
    assert not (tmp_path / "outside.txt").exists()
