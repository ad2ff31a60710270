"""What compiled arithmetic costs before it saves anything: the first use, and the start of every process.

Each is measured in a process of its own: the first keeps its machine code in an empty folder, the next ones
load it from there. A control step is timed in the last process, in turns with one that is not compiled.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import subprocess
import sys
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from measuring import perceptions, results
from measuring.command import options
from measuring.perceptions import Approach, Case
from measuring.solvers import FAST, solvers

CASE = Case(30, 5)
PLAIN = "osqp"


def started(passes: int) -> dict[str, float]:
    """Return what it takes until everything is compiled or loaded, and what a step takes then."""
    approaches = perceptions.record(CASE)
    times = {name: _first_pass(name, approaches) for name in (PLAIN, FAST)}
    steps: dict[str, list[float]] = {PLAIN: [], FAST: []}
    for _ in range(passes):
        for name in steps:
            steps[name] += [took for approach in approaches for took in _steps(name, approach)[1:]]
    return {
        "ready_s": times[FAST] - times[PLAIN],
        "saved_per_step_ms": 1e3 * (float(np.mean(steps[PLAIN])) - float(np.mean(steps[FAST]))),
    }


def _first_pass(name: str, approaches: list[Approach]) -> float:
    began = perf_counter()
    for approach in approaches:
        _steps(name, approach)
    return perf_counter() - began


def _steps(name: str, approach: Approach) -> list[float]:
    driver = perceptions.controller(CASE, name)
    return [perceptions.timed(driver, perception) for perception in approach]


def in_child(folder: str, passes: int) -> dict[str, float]:
    """Measure in a process of its own that keeps machine code in a folder."""
    command = [sys.executable, __file__, "--child", str(passes)]
    environment = {**os.environ, "NUMBA_CACHE_DIR": folder}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--child"]:
        print(json.dumps(started(int(sys.argv[2]))))
        return
    given = options(__doc__)
    if FAST not in solvers():
        print("skipped: compiled arithmetic, as Numba or DAQP is not installed (extra `fast`)")
        return
    with TemporaryDirectory() as folder:
        first = in_child(folder, 1)
        later = [in_child(folder, 1) for _ in range(1 if given.quick else 3)]
    found: dict[str, Any] = {
        "case": str(CASE),
        "first_s": first["ready_s"],
        "later_s": float(np.median([one["ready_s"] for one in later])),
        "saved_per_step_ms": float(np.median([one["saved_per_step_ms"] for one in later])),
    }
    for name in ("first", "later"):
        found[f"{name}_pays_after_steps"] = 1e3 * found[f"{name}_s"] / found["saved_per_step_ms"]
    print(
        f"compiling takes {found['first_s']:.1f} s once, loading {found['later_s']:.2f} s a process; "
        f"a step is {found['saved_per_step_ms']:.2f} ms shorter: paid for after "
        f"{found['first_pays_after_steps']:.0f} and {found['later_pays_after_steps']:.0f} steps"
    )
    results.publish("compiling", found, (), given.folder)


if __name__ == "__main__":
    main()
