"""Instructions instead of time: ours and the naive control step under valgrind's callgrind, where installed.

A machine's load changes no count. Both plan the same few recorded steps, one after the other; counting is on
for these alone.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from measuring import perceptions, results
from measuring.command import options
from measuring.perceptions import Case
from measuring.solvers import SOLVERS

CASE = Case(30, 5)
LONGEST_S = 300.0
"""Valgrind slows a program down by a factor of fifty; after this it is given up."""
FIRST, STEPS = 10, 5
"""Steps of the first approach that are counted."""


def counted_part(name: str) -> None:
    """Plan the counted steps; runs under callgrind."""
    import naive

    warnings.simplefilter("ignore")
    approach = perceptions.record(CASE, approaches=1)[0][: FIRST + STEPS]
    driver: Any = perceptions.controller(CASE, "osqp" if name == "naive" else name)
    for perception in approach[:FIRST]:
        driver.plan(perception, driver.decide(perception))
    if name == "naive":
        driver = naive.twin(driver, approach[FIRST])
    # What switching the counting itself takes goes into a file of its own.
    _callgrind("-i", "on")
    _callgrind("-i", "off")
    _callgrind("-d")
    _callgrind("-i", "on")
    for perception in approach[FIRST:]:
        driver.plan(perception, driver.decide(perception))
    _callgrind("-i", "off")


def _callgrind(*order: str) -> None:
    subprocess.run(["callgrind_control", *order, str(os.getpid())], check=True, capture_output=True)


def count(name: str) -> float | None:
    """Return the instructions of one control step; ``None`` when it takes too long."""
    with TemporaryDirectory() as folder:
        out = Path(folder) / "callgrind.out"
        command = [
            *("valgrind", "--tool=callgrind", "--instr-atstart=no", f"--callgrind-out-file={out}", "-q"),
            *(sys.executable, __file__, "--count", name),
        ]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            return None
        if done.returncode:
            raise SystemExit(f"callgrind with {name} ended with {done.returncode}: {done.stderr[-400:]}")
        switching, whole = (_total(Path(f"{out}{part}")) for part in (".1", ""))
    return (whole - switching) / STEPS


def _total(path: Path) -> float:
    found = re.findall(r"^(?:summary|totals): (\d+)", path.read_text(), re.MULTILINE)
    if not found:
        raise SystemExit(f"callgrind counted nothing: {path.name} has no total")
    return max(float(number) for number in found)


def main() -> None:
    """Count, print and publish."""
    if sys.argv[1:2] == ["--count"]:
        counted_part(sys.argv[2])
        return
    given = options(__doc__)
    if shutil.which("valgrind") is None:
        print("skipped: instruction counts, as valgrind is not installed")
        return
    names = SOLVERS[:1] if given.quick else (*SOLVERS, "naive")
    counts = {}
    for name in names:
        counts[name] = count(name)
        text = "took too long" if counts[name] is None else f"{counts[name] / 1e6:.1f} million instructions"
        print(f"{CASE}, {name}: {text} a control step", flush=True)
    found = {"case": str(CASE), "first": FIRST, "steps": STEPS, "counts": counts}
    results.publish("instructions", found, (), given.folder)


if __name__ == "__main__":
    main()
