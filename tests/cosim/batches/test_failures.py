"""Runs that raise, hang, crash or are killed, batches that are killed, and disks that are full."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import FrameType

import psutil  # type: ignore[import-untyped]
import pytest

from tests.cosim.batches import unruly
from tests.cosim.batches.disturbing import SMALL_DISK_OUT, can_mount, on_small_disk, workers
from tests.cosim.batches.studies import batch, lasting, rows, runs, write_study
from tests.cosim.cli.commands import command, finished, source_environment

pytestmark = [pytest.mark.sumo, pytest.mark.long]


def start(
    *arguments: object, folder: Path, environment: Mapping[str, str] | None = None
) -> subprocess.Popen[str]:
    """Start a batch in a process group of its own, as a shell does."""
    return subprocess.Popen(
        command("batch", *arguments),
        cwd=folder,
        env={**source_environment(), **(environment or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_for_runs(
    out: Path, count: int, process: subprocess.Popen[str] | None = None, seconds: float = 120.0
) -> None:
    """Wait until so many runs are finished and another one is being made, by a process or by this one."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and (process is None or process.poll() is None):
        if (out / "runs").is_dir() and len(runs(out)) >= count and any((out / ".work").glob("*/run/*")):
            return
        time.sleep(0.02)
    raise AssertionError(f"no {count} runs after {seconds} s: {process and process.poll()}")


def end(process: subprocess.Popen[str], seconds: float = 30.0) -> tuple[str, str]:
    """Wait until a batch and all its processes have ended, and return what they said.

    Raises
    ------
    AssertionError
        If one goes on. It tells which, and where in the code each of its threads is.
    """
    try:
        return process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        left = [
            one for one in psutil.process_iter() if one.is_running() and os.getsid(one.pid) == process.pid
        ]
        names = [f"{one.pid} of {one.ppid()}, {one.status()}: {' '.join(one.cmdline())}" for one in left]
        for number in (signal.SIGABRT, signal.SIGKILL):  # at the first of them, workers tell where they are
            for one in left:
                if one.is_running():
                    one.send_signal(number)
            time.sleep(1.0)
        said = "\n".join(process.communicate())
        raise AssertionError("\n".join(["these processes went on:", *names, said])) from None


def wait_until_gone(processes: list[psutil.Process], seconds: float = 10.0) -> None:
    """Wait until these processes have ended."""
    _, alive = psutil.wait_procs(processes, timeout=seconds)
    assert not alive


@pytest.mark.slow
def test_a_run_that_fails_in_any_way_is_told_and_harms_no_other(tmp_path: Path) -> None:
    reasons = {
        "raise": "ZeroDivisionError: one over nothing",
        "hang": "still running after run_timeout_s = 10 s",
        "hang_deaf": "still running after run_timeout_s = 10 s",
        "crash": "SIGSEGV",
        "kill": "SIGKILL",
        "leave": "exit code 5",
        "exit": "SystemExit: enough",
    }
    study = write_study(
        tmp_path,
        controllers=["sumo", "unruly"],
        seeds="1-2",
        vary={"behaviour": ["none", *reasons]},
        run_timeout_s=10,
    )
    environment = unruly.install(tmp_path / "plugin")
    done = batch(study, "--out", "out", "--jobs", 2, code=3, folder=tmp_path, environment=environment)
    out = tmp_path / "out"
    failed = rows(out / "failed.csv")
    assert len(failed) == 2 * len(reasons)
    for row in failed:
        behaviour = next(each for each in reasons if f"behaviour={each}-" in row["run"])
        assert reasons[behaviour] in row["reason"]
        assert row["attempts"] == "2"
        assert f"failed: {row['run']}: {row['reason']}" in done.stderr
    assert len(runs(out)) == 4
    assert all(row["valid"] == "1" for row in rows(out / "runs.csv") if row["controller"] == "sumo")
    assert f"{len(failed)} runs failed; for the reasons see out/failed.csv" in done.stderr
    crash = json.loads(next((out / "failed").glob("*crash-seed1*/failure.json")).read_text())
    text = "\n".join(crash["last_lines"])
    assert "Segmentation fault" in text
    assert "unruly.py" in text
    hang = json.loads(next((out / "failed").glob("*behaviour=hang-seed1*/failure.json")).read_text())
    assert "unruly.py" in "\n".join(hang["last_lines"])


def test_a_run_that_fails_once_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unruly.use(tmp_path / "plugin", monkeypatch)
    study = write_study(tmp_path, controllers=["unruly"], seeds="1", vary={"behaviour": ["once_a", "once_b"]})
    done = batch(study, "--out", "out", "--jobs", 1, folder=tmp_path)
    assert "2 of 2 runs finished, 0 failed" in done.stdout
    assert len(list((tmp_path / "plugin" / "marks").iterdir())) == 2


@pytest.mark.slow
def test_a_failed_run_is_made_by_the_same_command_once_its_cause_is_gone(tmp_path: Path) -> None:
    environment = unruly.install(tmp_path / "plugin")
    study = write_study(tmp_path, controllers=["unruly"], seeds="1", vary={"behaviour": ["none", "raise"]})
    batch(study, "--out", "out", code=3, folder=tmp_path, environment=environment)
    assert [row["valid"] for row in rows(tmp_path / "out" / "runs.csv")].count("1") == 1
    repaired = (tmp_path / "plugin" / "unruly.py").read_text().replace("raise ZeroDivisionError", "return  #")
    (tmp_path / "plugin" / "unruly.py").write_text(repaired)
    done = batch(study, "--out", "out", code=2, folder=tmp_path, environment=environment)
    assert "source code of the tool or of a controller has changed" in done.stderr
    shutil.rmtree(tmp_path / "out" / "runs" / runs(tmp_path / "out")[0])
    batch(study, "--out", "out", folder=tmp_path, environment=environment)
    assert rows(tmp_path / "out" / "failed.csv") == []
    assert list((tmp_path / "out" / "failed").iterdir()) == []


@pytest.mark.slow
def test_a_batch_that_is_killed_again_and_again_ends_with_the_same_tables(tmp_path: Path) -> None:
    study = write_study(
        tmp_path, controllers=["sumo", "aeb"], set={"warmup_s": 5, "duration_s": 20}, seeds="1-5"
    )
    batch(study, "--out", "whole", "--jobs", 2, folder=tmp_path)
    out = tmp_path / "out"
    for count in (1, 4, 7):
        process = start(study, "--out", "out", "--jobs", 2, folder=tmp_path)
        wait_for_runs(out, count, process)
        children = psutil.Process(process.pid).children(recursive=True)
        assert len(children) >= 2
        process.kill()
        process.communicate()
        wait_until_gone(children)
        assert count <= len(runs(out)) < 10
    batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)
    assert lasting(out) == lasting(tmp_path / "whole")
    assert not (out / ".work").exists()


@contextmanager
def termination(beside: Callable[[], object]) -> Iterator[None]:
    """Send SIGTERM to this process as soon as a function, called in a thread, has returned."""

    def tell_to_end() -> None:
        beside()
        os.kill(os.getpid(), signal.SIGTERM)

    def unhandled(number: int, frame: FrameType | None) -> None:
        raise AssertionError("nothing handled SIGTERM")

    before = signal.signal(signal.SIGTERM, unhandled)
    try:
        with ThreadPoolExecutor(1) as thread:
            told = thread.submit(tell_to_end)
            yield
            told.result()
    finally:
        signal.signal(signal.SIGTERM, before)


def test_a_batch_that_is_told_to_end_before_its_first_run_says_so(tmp_path: Path) -> None:
    study = write_study(tmp_path, vary={"vehicles_per_hour": list(range(100, 400))})

    def checked() -> None:
        deadline = time.monotonic() + 60.0
        while not workers(os.getpid()) and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(1.0)  # the first configurations are being checked

    with termination(checked):
        done = batch(study, "--out", "out", "--jobs", 1, code=3, folder=tmp_path)
    assert done.stdout == ""
    last = done.stderr.strip().splitlines()[-1]
    assert last.endswith(f"cosim: interrupted while {study} was checked; nothing was run")
    assert not (tmp_path / "out").exists()
    wait_until_gone(workers(os.getpid()))


def stopped_apart(study: Path, folder: Path, number: signal.Signals) -> tuple[int, str, str]:
    """Stop a batch in a process of its own by a signal; return its exit code and what it said."""
    process = start(study, "--out", "out", "--jobs", 2, folder=folder)
    wait_for_runs(folder / "out", 2, process)
    children = psutil.Process(process.pid).children(recursive=True)
    if number == signal.SIGINT:
        os.killpg(process.pid, number)  # as a terminal does
    else:
        process.send_signal(number)
    said = end(process)
    wait_until_gone(children)
    return process.returncode, *said


def stopped_here(study: Path, folder: Path) -> tuple[int, str, str]:
    """Stop a batch of this process by SIGTERM; return its exit code and what it said."""
    with termination(lambda: wait_for_runs(folder / "out", 2)):
        done = finished("batch", study, "--out", "out", "--jobs", 2, folder=folder)
    wait_until_gone(workers(os.getpid()))
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    "stopped",
    [
        pytest.param(partial(stopped_apart, number=signal.SIGINT), id="SIGINT"),
        pytest.param(stopped_here, id="SIGTERM"),
        pytest.param(
            partial(stopped_apart, number=signal.SIGTERM), id="SIGTERM apart", marks=pytest.mark.slow
        ),
    ],
)
def test_a_batch_that_is_told_to_end_says_how_to_go_on(
    tmp_path: Path, stopped: Callable[[Path, Path], tuple[int, str, str]]
) -> None:
    study = write_study(tmp_path, seeds="1-500")
    code, stdout, stderr = stopped(study, tmp_path)
    assert code == 3, stderr
    done = len(runs(tmp_path / "out"))
    assert f"{done} of 500 runs finished" in stdout
    assert "interrupted" in stderr
    assert f"cosim batch {study} --out out --jobs 2" in stderr
    assert "Traceback" not in stderr
    assert len(rows(tmp_path / "out" / "runs.csv")) == done
    assert not (tmp_path / "out" / ".work").exists()


def test_a_worker_that_is_killed_from_outside_costs_one_attempt(tmp_path: Path) -> None:
    study = write_study(tmp_path, set={"warmup_s": 2, "duration_s": 15}, seeds="1-4")

    def kill_workers() -> None:
        wait_for_runs(tmp_path / "out", 1)
        found = workers(os.getpid())
        assert found
        for one in found:
            one.kill()

    with ThreadPoolExecutor(1) as beside:
        killed = beside.submit(kill_workers)
        done = batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)
        killed.result()
    assert "4 of 4 runs finished, 0 failed" in done.stdout


@pytest.mark.slow
def test_files_that_may_not_grow_end_the_batch_and_leave_whole_runs(tmp_path: Path) -> None:
    study = write_study(tmp_path, set={"warmup_s": 2}, vary={"duration_s": [5, 120]}, seeds="1-2")
    line = " ".join(command("batch", study, "--out", "out", "--jobs", 1))
    done = subprocess.run(
        ["bash", "-c", f"ulimit -f 60; {line}"],
        cwd=tmp_path,
        env=source_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3, done.stderr
    assert "no room for files" in done.stderr
    assert "File too large" in done.stderr
    assert [name for name in runs(tmp_path / "out") if "duration_s=5-" not in name] == []
    batch(study, "--out", "out", folder=tmp_path)
    assert len(runs(tmp_path / "out")) == 4


def test_a_disk_that_fills_up_ends_the_batch_and_leaves_whole_runs(tmp_path: Path) -> None:
    if not can_mount():
        pytest.skip("no file system can be mounted here")
    study = write_study(tmp_path, seeds="1-10")
    done = subprocess.run(
        on_small_disk(command("batch", study, "--out", SMALL_DISK_OUT, "--jobs", 2), 800, "saved"),
        cwd=tmp_path,
        env=source_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3, done.stderr
    assert "no room for files" in done.stderr
    assert "Traceback" not in done.stderr
    saved = runs(tmp_path / "saved")
    assert 0 < len(saved) < 10
    # What is whole is taken over as it is, on a disk with room.
    before = lasting_bytes(tmp_path / "saved")
    batch(study, "--out", "saved", "--jobs", 2, folder=tmp_path)
    after = lasting_bytes(tmp_path / "saved")
    assert len(runs(tmp_path / "saved")) == 10
    assert {path: after[path] for path in before} == before


def lasting_bytes(out: Path) -> dict[str, bytes]:
    """Return the content of every file of the finished runs."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in (out / "runs").rglob("*.*")
        if path.is_file()
    }
