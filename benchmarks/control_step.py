"""How long a control step takes, and how much longer the same step takes when written naively.

Run with ``make bench``. Both drive along the same recorded perceptions, in turns, in one process: the
naive controller is a copy of ours as it stands before the step, so that it solves the same programs.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gc
import sys
import warnings
from collections.abc import Sequence
from contextlib import nullcontext
from time import perf_counter
from typing import Any

import naive
import numpy as np
from measuring import agreement, perceptions, results
from measuring.perceptions import CASES, Approach, Case
from measuring.stopwatch import OTHER, Stopwatch, watching
from numpy.typing import NDArray

from controllers import passing
from controllers.interface import Perception
from controllers.lateral import LateralProgram
from controllers.longitudinal import LongitudinalProgram
from controllers.qp import Program
from controllers.speed_planning import SpeedPlanner

FloatArray = NDArray[np.float64]

REPETITIONS = 5
NAIVE = "naive"
NAIVE_STEPS = 20
"""Control steps per repetition that the naive controller repeats; it is the slow one."""
PARTS = ("conflicts", "assembly", "solve", "steering", OTHER)
PLACES = (
    (passing, "find", "conflicts"),
    (passing, "class_bounds", "conflicts"),
    (SpeedPlanner, "_candidates", "conflicts"),
    (LongitudinalProgram, "build", "assembly"),
    (Program, "solve", "solve"),
    (LateralProgram, "solve", "steering"),
    (naive.NaiveSpeedProgram, "build", "assembly"),
    (naive, "solve", "solve"),
    (naive.NaiveSteeringProgram, "solve", "steering"),
)
"""What belongs to which part; ``steering`` keeps its own assembly and solve."""


def solvers() -> tuple[str, ...]:
    """Return the solvers to measure: OSQP, and DAQP where it is installed."""
    import qpsolvers

    return ("osqp", *(name for name in ("daqp",) if name in qpsolvers.available_solvers))


def repetition(case: Case, approaches: Sequence[Approach], parts: bool = False) -> dict[str, dict[str, Any]]:
    """Return the times of each control step of one pass over all approaches [s], by controller.

    With ``parts`` also the mean time per step by part; the clock's own cost is then in all of them.
    """
    names = (*solvers(), NAIVE)
    times: dict[str, list[float]] = {name: [] for name in names}
    compared: dict[str, list[float]] = {name: [] for name in names}
    watches = {name: Stopwatch(whole=("steering",)) for name in names}
    every = max(1, sum(len(approach) - 1 for approach in approaches) // NAIVE_STEPS)
    count = 0
    for approach in approaches:
        drivers = {name: perceptions.controller(case, name) for name in solvers()}
        for i, perception in enumerate(approach):
            count += 1
            turn: dict[str, Any] = dict(drivers)
            with_naive = i > 0 and count % every == 0
            if with_naive:
                turn[NAIVE] = naive.twin(drivers["osqp"], perception)
            order = list(turn) if count // every % 2 else list(reversed(turn))
            gc.collect(0)
            for name in order:
                with watching(watches[name], PLACES) if parts and i else nullcontext():
                    took = _timed(turn[name], perception, watches[name] if parts and i else None)
                # The first step of an approach builds the programs.
                if i:
                    times[name].append(took)
                    if with_naive:
                        compared[name].append(took)
    return {
        name: {"times": np.array(times[name]), "compared": np.array(compared[name]), "watch": watches[name]}
        for name in names
    }


def _timed(driver: Any, perception: Perception, watch: Stopwatch | None) -> float:
    with watch.part(OTHER) if watch else nullcontext():
        began = perf_counter()
        driver.plan(perception, driver.decide(perception))
        return perf_counter() - began


def measure(case: Case) -> dict[str, Any]:
    """Return times, ratios and parts of one case."""
    approaches = perceptions.record(case)
    repetition(case, approaches[:1])
    runs = [repetition(case, approaches) for _ in range(REPETITIONS)]
    split = repetition(case, approaches, parts=True)
    entry: dict[str, Any] = {"times": {}, "ratio": {}, "parts_ms": {}, "programs_per_step": {}}
    for name in runs[0]:
        every = 1e3 * np.concatenate([run[name]["times"] for run in runs])
        entry["times"][name] = {
            "steps": len(every),
            "median_ms": float(np.median(every)),
            "p95_ms": float(np.percentile(every, 95)),
            "p99_ms": float(np.percentile(every, 99)),
        }
        if name != NAIVE:
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
        watch, steps = split[name]["watch"], len(split[name]["times"])
        entry["parts_ms"][name] = {part: 1e3 * watch.seconds.get(part, 0.0) / steps for part in PARTS}
        entry["programs_per_step"][name] = watch.calls.get("assembly", 0) / steps
    return entry


def show(case: Case, entry: dict[str, Any]) -> None:
    """Print one case."""
    for name, times in entry["times"].items():
        ratio = entry["ratio"].get(name, {"median": 1.0, "least": 1.0, "most": 1.0, "of_sums": 1.0})
        parts = "  ".join(f"{part} {value:.2f}" for part, value in entry["parts_ms"][name].items())
        print(
            f"{case!s:6}{name:6} median {times['median_ms']:7.2f}  p95 {times['p95_ms']:7.2f}  "
            f"p99 {times['p99_ms']:7.2f} ms   naive/it {ratio['median']:5.1f} "
            f"({ratio['least']:.1f} to {ratio['most']:.1f}; of sums {ratio['of_sums']:.1f})   {parts}",
            flush=True,
        )


def main(only: Sequence[str]) -> None:
    """Measure the cases, all or those named as ``steps/pedestrians``."""
    cases = tuple(case for case in CASES if not only or str(case) in only)
    if not cases:
        raise SystemExit(f"no such case; there are {', '.join(map(str, CASES))}")
    warnings.simplefilter("ignore")  # OSQP's hint that a naive program was given up
    gc.disable()
    found = {}
    for case in cases:
        found[str(case)] = measure(case)
        show(case, found[str(case)])
    agreed = agreement.check(cases)
    if results.BAR_CASE in found:
        print(*results.bar(found), sep="\n")
    if len(cases) == len(CASES):
        results.publish("control_step", found)
        results.publish("agreement", agreed)


if __name__ == "__main__":
    main(sys.argv[1:])
