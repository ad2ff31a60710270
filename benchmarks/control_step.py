"""How long a control step takes, and how much longer the same step takes when written naively.

Both drive along the same recorded perceptions, in turns, in one process: the naive controller is a copy of
ours as it stands before the step, so that it solves the same programs.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gc
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import naive
import numpy as np
from measuring import agreement, allocations, perceptions, results
from measuring.bars import Bar, show
from measuring.command import options
from measuring.control_parts import PARTS, Programs, observed
from measuring.perceptions import CASES, Approach, Case
from measuring.solvers import DEFAULT, SOLVERS
from measuring.stopwatch import OTHER, Stopwatch
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

NAIVE = "naive"
NAIVE_STEPS = 20
"""Control steps per repetition that the naive controller repeats; it is the slow one."""
BARRED = (Case(30, 5), Case(30, 20))
LEAST_RATIO = 8.0
"""Naive over ours, with the default solver, at the median control step."""
MOST_SPREAD = 8.0
"""99th percentile over median of a control step."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is measured."""

    repetitions: int = 5
    counted_steps: int = 10_000
    """Steps over which memory is watched."""
    cases: tuple[Case, ...] = CASES


QUICK = Effort(1, 60, (Case(30, 5),))


def repetition(case: Case, approaches: Sequence[Approach]) -> dict[str, dict[str, FloatArray]]:
    """Return the times of each control step of one pass over all approaches [s], by controller.

    They take turns approach by approach: step by step each would find the caches full of the others' data.
    """
    names = [*SOLVERS, NAIVE]
    times: dict[str, list[float]] = {name: [] for name in names}
    compared: dict[str, list[float]] = {name: [] for name in names}
    every = max(1, sum(len(approach) - 1 for approach in approaches) // NAIVE_STEPS)
    for number, approach in enumerate(approaches):
        for name in names if number % 2 else reversed(names):
            took = _naive(case, approach, every) if name == NAIVE else _ours(case, approach, name)
            times[name] += took
            compared[name] += took if name == NAIVE else took[::every]
    return {name: {"times": np.array(times[name]), "compared": np.array(compared[name])} for name in names}


def _ours(case: Case, approach: Approach, name: str) -> list[float]:
    """Return what each step but the first takes, which builds the programs [s]."""
    driver = perceptions.controller(case, name)
    perceptions.timed(driver, approach[0])
    gc.collect(0)
    return [perceptions.timed(driver, perception) for perception in approach[1:]]


def _naive(case: Case, approach: Approach, every: int) -> list[float]:
    """Return what the naive controller takes for every so many of these steps [s]."""
    driver = perceptions.controller(case, DEFAULT)
    perceptions.timed(driver, approach[0])
    found = []
    for i, perception in enumerate(approach[1:]):
        if i % every == 0:
            twin = naive.twin(driver, perception)
            gc.collect(0)
            found.append(perceptions.timed(twin, perception))
        perceptions.timed(driver, perception)
    return found


def split(case: Case, approaches: Sequence[Approach], solver: str) -> dict[str, dict[str, float]]:
    """Return mean, median and 99th percentile of the time per control step, by part."""
    watch = Stopwatch()
    with observed(Programs(), watch):
        for approach in approaches:
            driver = perceptions.controller(case, solver)
            for i, perception in enumerate(approach):
                with watch.part(OTHER):
                    driver.plan(perception, driver.decide(perception))
                watch.end_step()
                if i == 0:
                    watch.steps.pop()
    return watch.spread(PARTS)


def programs(case: Case, approaches: Sequence[Approach], solver: str, times: int) -> dict[str, Any]:
    """Return how programs were solved and how long that took."""
    seconds: dict[str, list[list[float]]] = {"speed": [], "steering": []}
    steps = sum(len(approach) - 1 for approach in approaches)
    for _ in range(times):
        counted = Programs()
        for approach in approaches:
            driver = perceptions.controller(case, solver)
            perceptions.timed(driver, approach[0])
            with observed(counted):
                for perception in approach[1:]:
                    driver.plan(perception, driver.decide(perception))
        for kind, values in counted.seconds.items():
            seconds[kind].append(values)
    found: dict[str, Any] = {
        "per_step": counted.count / steps,
        "unsolved": counted.unsolved,
    }
    for kind, repeats in seconds.items():
        # The programs are the same in every repetition: everything is deterministic.
        table = 1e3 * np.array(repeats)
        quiet, median = np.median(table, axis=0), float(np.median(table))
        p99 = float(np.percentile(table, 99))
        found[kind] = {
            "solves": table.shape[1],
            "median_ms": median,
            "p99_ms": p99,
            "p99_over_median": p99 / median,
            "p99_over_median_quiet": float(np.percentile(quiet, 99) / np.median(quiet)),
        }
    return found


def measure(case: Case, effort: Effort) -> dict[str, Any]:
    """Return times, ratios, parts and programs of one case."""
    approaches = perceptions.record(case)
    repetition(case, approaches[:1])
    runs = [repetition(case, approaches) for _ in range(effort.repetitions)]
    entry: dict[str, Any] = {"times": {}, "ratio": {}, "parts": {}, "programs": {}}
    for name in runs[0]:
        every = 1e3 * np.concatenate([run[name]["times"] for run in runs])
        entry["times"][name] = {
            "steps": len(every),
            "median_ms": float(np.median(every)),
            "p95_ms": float(np.percentile(every, 95)),
            "p99_ms": float(np.percentile(every, 99)),
        }
        if name == NAIVE:
            continue
        ratios = [np.median(run[NAIVE]["compared"]) / np.median(run[name]["compared"]) for run in runs]
        entry["ratio"][name] = {
            "median": float(np.median(ratios)),
            "least": float(min(ratios)),
            "most": float(max(ratios)),
            "of_sums": float(
                sum(run[NAIVE]["compared"].sum() for run in runs)
                / sum(run[name]["compared"].sum() for run in runs)
            ),
        }
        entry["parts"][name] = split(case, approaches, name)
        entry["programs"][name] = programs(case, approaches, name, effort.repetitions)
    return entry


def report(case: Case, entry: dict[str, Any]) -> None:
    """Print one case."""
    for name, times in entry["times"].items():
        text = f"{case!s:6}{name:6} median {times['median_ms']:7.2f}  p99 {times['p99_ms']:7.2f} ms"
        if name in entry["ratio"]:
            ratio, solves = entry["ratio"][name], entry["programs"][name]
            parts = "  ".join(
                f"{part} {value['median_ms']:.2f}" for part, value in entry["parts"][name].items()
            )
            text += (
                f"   naive/it {ratio['median']:5.1f} ({ratio['least']:.1f} to {ratio['most']:.1f}; of sums "
                f"{ratio['of_sums']:.1f})   unsolved {solves['unsolved']}   {parts}"
            )
        print(text, flush=True)


def bars(found: dict[str, Any]) -> list[Bar]:
    """Return what is asked of the measured cases."""
    asked = []
    for case in BARRED:
        entry = found.get(str(case))
        if entry is None:
            continue
        size = f"N = {case.steps}, {case.pedestrians} pedestrians, {DEFAULT}"
        ratio, times = entry["ratio"][DEFAULT], entry["times"][DEFAULT]
        asked.append(
            Bar(
                what=f"control step against naive, {size}",
                measured=ratio["median"],
                at_least=LEAST_RATIO,
                note=f"{ratio['least']:.1f} to {ratio['most']:.1f}; of total times {ratio['of_sums']:.1f}",
            )
        )
        asked.append(
            Bar(
                what=f"p99 over median of a control step, {size}",
                measured=times["p99_ms"] / times["median_ms"],
                at_most=MOST_SPREAD,
                unit="",
            )
        )
    return asked


def main() -> None:
    """Measure, print and publish."""
    given = options(__doc__)
    effort = QUICK if given.quick else Effort()
    warnings.simplefilter("ignore")  # OSQP's hint that a naive program was given up
    for solver in SOLVERS:
        perceptions.warm_up(Case(30, 5), solver)
    gc.disable()
    cases = {}
    for case in effort.cases:
        cases[str(case)] = measure(case, effort)
        report(case, cases[str(case)])
    agreed = agreement.check(effort.cases)
    held = {}
    for solver in SOLVERS:
        held[solver] = allocations.watch(Case(30, 5), solver, effort.counted_steps)
        print(f"{solver}: {allocations.told(held[solver])}", flush=True)
    asked = [*bars(cases), *allocations.bars(held)]
    show(asked)
    results.publish("control_step", {"cases": cases, "allocations": held}, asked, given.folder)
    results.publish("agreement", {"programs": agreed}, (), given.folder)


if __name__ == "__main__":
    main()
