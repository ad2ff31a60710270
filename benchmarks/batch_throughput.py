"""What the batch machinery costs: against plain processes, against plain calls, and in memory.

Run with ``make bench``. What is compared takes turns, because the speed of a machine drifts.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import ctypes
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any

import numpy as np
from measuring import results
from measuring.bars import Bar, show
from measuring.command import options

from cosim.batches.job import Configuration, Job
from cosim.batches.pool import RUNS_PER_PROCESS, Pool
from cosim.batches.worker import Handling

ROUNDS = 3
RUNS = {1: 20, 2: 40}
"""Runs of a round, by how many run at a time."""
SHELL_RUNS = {1: 5, 2: 10}
"""Runs that shells start, which take longest; the rest is reckoned from these."""
SCENARIO, CONTROLLER = "midblock_zebra", "aeb"
SETTINGS = {"warmup_s": 20, "duration_s": 60}
SHORT = {"warmup_s": 2, "duration_s": 6}
SHORT_RUNS = 500
SETTLED = 20
"""Runs after which memory is looked at."""
SHORTEST = {"warmup_s": 0, "duration_s": 1}
PARENT_RUNS, PARENT_SETTLED, LOOKS_S = 1000, 100, 0.5
"""Runs of the batch whose own process is looked at, those before that counts, and how often [s]."""

PR_SET_CHILD_SUBREAPER = 36
"""Of prctl(2)."""
LEAST_THROUGHPUT = 0.95
MOST_OVERHEAD = 0.10
MOST_MB_PER_100_RUNS = 1.0
MOST_MORE_FILES = 2

IN_TURN = """
import sys
from pathlib import Path
from cosim.running.execution import execute
from cosim.running.request import RunRequest, parse_settings
from cosim.running.request import RunRequest

out, first, step, last, scenario, controller, *texts = sys.argv[1:]
settings = parse_settings(texts)
for seed in range(int(first), int(last) + 1, int(step)):
    execute(RunRequest(scenario, controller, seed, settings, out=Path(out) / str(seed)))
"""


def batch(
    folder: Path, jobs: int, runs: int, settings: Mapping[str, float] = MappingProxyType(SETTINGS)
) -> list[list[str]]:
    """Return the command of a batch, as the only one."""
    lines = [
        f'scenarios = ["{SCENARIO}"]',
        f'controllers = ["{CONTROLLER}"]',
        f'seeds = "1-{runs}"',
        "[set]",
        *(f"{key} = {value}" for key, value in settings.items()),
    ]
    (folder / "study.toml").write_text("\n".join(lines))
    options = ["--out", str(folder / "out"), "--jobs", str(jobs)]
    return [[sys.executable, "-m", "cosim.cli", "batch", str(folder / "study.toml"), *options]]


def in_turn(folder: Path, processes: int, runs: int) -> list[list[str]]:
    """Return commands that call the same runs one after the other, shared among processes."""
    settings = [f"{key}={value}" for key, value in SETTINGS.items()]
    return [
        [
            *(sys.executable, "-c", IN_TURN, str(folder), str(first), str(processes), str(runs)),
            *(SCENARIO, CONTROLLER, *settings),
        ]
        for first in range(1, processes + 1)
    ]


def shells(folder: Path, processes: int, runs: int) -> list[list[str]]:
    """Return shells that start ``cosim run`` for each of the same runs, shared among them."""
    settings = " ".join(f"--set {key}={value}" for key, value in SETTINGS.items())
    run = f"{sys.executable} -m cosim.cli run {SCENARIO} --controller {CONTROLLER} {settings}"
    share = "for seed in $(seq {} {} {}); do {} --seed $seed --out {}/$seed; done"
    return [
        ["bash", "-ec", share.format(first, processes, runs, run, folder)]
        for first in range(1, processes + 1)
    ]


def timed(commands: list[list[str]]) -> tuple[float, float]:
    """Return the wall-clock time until all commands have ended, and the processor time they used [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.perf_counter()
    quiet = subprocess.DEVNULL
    processes = [subprocess.Popen(command, stdout=quiet, stderr=quiet) for command in commands]
    codes = [process.wait() for process in processes]
    wall_s = time.perf_counter() - started
    _wait_for_orphans()
    if any(codes):
        raise SystemExit(f"{commands[0][:4]} ended with {codes}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _adopt_orphans() -> None:
    """Become the parent of what outlives a batch: the process that forks workers, which knows their time."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def _wait_for_orphans() -> None:
    with suppress(ChildProcessError):
        while True:
            os.wait()


def compared(processes: int, rounds: int, runs: int, shell_runs: int) -> dict[str, Any]:
    """Return times of a batch and of plain processes, taken in turns; of shells once, on fewer runs."""
    kinds = {"batch": batch, "in turn": in_turn, "shells": shells}
    wall: dict[str, list[float]] = {kind: [] for kind in kinds}
    cpu: dict[str, list[float]] = {kind: [] for kind in kinds}
    for number in range(rounds):
        order = ["batch", "in turn"] if number % 2 == 0 else ["in turn", "batch"]
        for kind in (*order, "shells") if number == 0 else order:
            with TemporaryDirectory() as folder:
                own = shell_runs if kind == "shells" else runs
                wall_s, cpu_s = timed(kinds[kind](Path(folder), processes, own))
            wall[kind].append(wall_s * runs / own)
            cpu[kind].append(cpu_s * runs / own)
    ratios = [plain / own for plain, own in zip(wall["in turn"], wall["batch"], strict=True)]
    return {
        "runs": runs,
        "shell_runs": shell_runs,
        "wall_s": {kind: median(values) for kind, values in wall.items()},
        "cpu_s": {kind: median(values) for kind, values in cpu.items()},
        "throughput_ratio": median(ratios),
        "throughput_ratios": ratios,
        "throughput_ratio_shells": wall["shells"][0] / wall["batch"][0],
        "cpu_ratio": median(own / plain for plain, own in zip(cpu["in turn"], cpu["batch"], strict=True)),
    }


def memory(runs: int) -> dict[str, Any]:
    """Return how the memory of a worker grows over many short runs: as used, and within one process."""
    pairs = tuple((key, str(value)) for key, value in SHORT.items())
    one = Configuration(SCENARIO, SCENARIO, SCENARIO, CONTROLLER, pairs, (), ())
    sizes_mb: list[float] = []
    with TemporaryDirectory() as folder, Pool(1, Handling(600.0)) as pool:
        for seed in range(1, runs + 1):
            place = Path(folder) / str(seed)
            outcome = pool.submit(Job(one, seed), place).result()
            if outcome.reason:
                raise SystemExit(outcome.reason)
            sizes_mb.append(_largest_child_mb())
            shutil.rmtree(place)
    settled, first = min(SETTLED, runs // 2), sizes_mb[: RUNS_PER_PROCESS - 1]
    return {
        "runs": runs,
        "runs_per_process": RUNS_PER_PROCESS,
        "most_mb": max(sizes_mb),
        "mb_per_100_runs": _slope(range(settled, runs), sizes_mb[settled:]),
        "mb_per_100_runs_within_a_process": _slope(range(settled, len(first)), first[settled:]),
    }


def parent(runs: int) -> dict[str, Any]:
    """Return how the memory and the open files of a batch's own process grow over many very short runs."""
    import psutil

    looks: list[tuple[int, float, int]] = []
    with TemporaryDirectory() as folder:
        (command,) = batch(Path(folder), 2, runs, SHORTEST)
        quiet = subprocess.DEVNULL
        process = subprocess.Popen(command, stdout=quiet, stderr=quiet)
        seen, made = psutil.Process(process.pid), Path(folder) / "out" / "runs"
        while process.poll() is None:
            done = len(list(made.iterdir())) if made.is_dir() else 0
            if done < runs:  # at the end the tables are written, in more memory
                looks.append((done, seen.memory_info().rss / 1e6, seen.num_fds()))
            time.sleep(LOOKS_S)
        if process.returncode:
            raise SystemExit(f"the batch ended with {process.returncode}")
    settled = [look for look in looks if look[0] >= PARENT_SETTLED] or looks[-1:]
    finished, sizes_mb, files = zip(*settled, strict=True)
    return {
        "runs": runs,
        "most_mb": max(sizes_mb),
        "mb_per_100_runs": _slope(finished, sizes_mb),
        "files": [min(files), max(files)],
    }


def _slope(runs: Sequence[int], sizes_mb: Sequence[float]) -> float:
    """Return the slope of the straight line that fits best, per 100 runs; 0 at a single number of runs."""
    return 100.0 * float(np.polyfit(runs, sizes_mb, 1)[0]) if len(set(runs)) > 1 else 0.0


def _largest_child_mb() -> float:
    """Return the resident memory of the worker, the largest of our children [MB]."""
    import psutil

    # Workers are children of the process that forks them.
    return max(child.memory_info().rss for child in psutil.Process().children(recursive=True)) / 1e6


def bars(found: dict[str, Any]) -> list[Bar]:
    """Return what is asked of a batch."""
    one, two, held, own = found["jobs_1"], found["jobs_2"], found["memory"], found["parent"]
    spread = f"{min(two['throughput_ratios']):.2f} to {max(two['throughput_ratios']):.2f}"
    return [
        Bar(
            what="throughput of a batch with two processes over two that call the same runs in turn",
            measured=two["throughput_ratio"],
            at_least=LEAST_THROUGHPUT,
            note=f"{spread}; {two['throughput_ratio_shells']:.2f} of two shells that start cosim run",
        ),
        Bar(
            what="overhead of a batch over the same runs called in turn in one process",
            measured=100.0 * (1.0 / one["throughput_ratio"] - 1.0),
            at_most=100.0 * MOST_OVERHEAD,
            unit="%",
            note=f"of wall-clock time; {one['cpu_ratio'] - 1.0:+.1%} of processor time",
        ),
        Bar(
            what=f"growth of a worker's memory in 100 short runs, over {held['runs']}",
            measured=held["mb_per_100_runs"],
            at_most=MOST_MB_PER_100_RUNS,
            unit="MB",
            note=f"its process replaced after every {held['runs_per_process']} runs; "
            f"{held['mb_per_100_runs_within_a_process']:+.2f} MB within a process, most of it kept by SUMO",
        ),
        Bar(
            what=f"growth of the batch's own memory in 100 runs, over {own['runs']}",
            measured=own["mb_per_100_runs"],
            at_most=MOST_MB_PER_100_RUNS,
            unit="MB",
            note=f"at most {own['most_mb']:.0f} MB",
        ),
        Bar(
            what="more files open in the batch's own process at one time than at another",
            measured=float(own["files"][1] - own["files"][0]),
            at_most=float(MOST_MORE_FILES),
            note=f"{own['files'][0]} to {own['files'][1]}",
        ),
    ]


def main() -> None:
    """Measure, print and publish."""
    given = options(__doc__)
    _adopt_orphans()
    rounds, short_runs = (1, 6) if given.quick else (ROUNDS, SHORT_RUNS)
    found: dict[str, Any] = {"rounds": rounds, "simulated_s": SETTINGS["duration_s"]}
    for processes in (1, 2):
        runs, shell_runs = (2, 2) if given.quick else (RUNS[processes], SHELL_RUNS[processes])
        entry = found[f"jobs_{processes}"] = compared(processes, rounds, runs, shell_runs)
        times = ", ".join(f"{kind} {value:.1f} s" for kind, value in entry["wall_s"].items())
        print(f"{runs} runs, {processes} at a time: {times}", flush=True)
    found["memory"] = memory(short_runs)
    found["parent"] = parent(6 if given.quick else PARENT_RUNS)
    asked = bars(found)
    show(asked)
    results.publish("batch", found, asked, given.folder)


if __name__ == "__main__":
    main()
