"""How the cost of a control step grows with the horizon and with the number of pedestrians."""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gc
from typing import Any

import numpy as np
from measuring import perceptions, results
from measuring.command import options
from measuring.perceptions import Case
from measuring.solvers import SOLVERS

HORIZONS = tuple(Case(steps, 5) for steps in (10, 20, 30, 40, 50, 60))
CROWDS = tuple(Case(30, people) for people in (0, 1, 5, 10, 20, 50, 100))
QUICK_HORIZONS, QUICK_CROWDS = HORIZONS[:2], CROWDS[2:4]
FEWEST_PEOPLE = 5
"""Fewer say nothing about growth: what does not depend on them is most of the cost."""
PASSES = 3


def measure(cases: tuple[Case, ...], passes: int) -> dict[str, dict[str, dict[str, float]]]:
    """Return median and mean of the control step [ms], by case and solver; the cases take turns."""
    for solver in SOLVERS:
        perceptions.warm_up(Case(30, 5), solver)
    recorded = {case: perceptions.record(case) for case in cases}
    times: dict[tuple[Case, str], list[float]] = {(case, s): [] for case in cases for s in SOLVERS}
    for _ in range(passes):
        for case, approaches in recorded.items():
            for solver in SOLVERS:
                for approach in approaches:
                    driver = perceptions.controller(case, solver)
                    gc.collect(0)
                    for i, perception in enumerate(approach):
                        took = perceptions.timed(driver, perception)
                        if i:  # the first step builds the programs
                            times[case, solver].append(1e3 * took)
    return {
        str(case): {
            solver: {
                "median_ms": float(np.median(times[case, solver])),
                "mean_ms": float(np.mean(times[case, solver])),
            }
            for solver in SOLVERS
        }
        for case in cases
    }


def exponents(sizes: list[int], entries: list[dict[str, dict[str, float]]]) -> dict[str, dict[str, float]]:
    """Return k of the law ``cost ~ size^k``: the slope of the straight line in logarithms, by solver."""
    found = {}
    for solver in SOLVERS:
        found[solver] = {
            kind: float(np.polyfit(np.log(sizes), np.log([entry[solver][kind] for entry in entries]), 1)[0])
            for kind in ("median_ms", "mean_ms")
        }
    return found


def main() -> None:
    """Measure, print and publish."""
    given = options(__doc__)
    gc.disable()
    passes = 1 if given.quick else PASSES
    horizons, crowds = (QUICK_HORIZONS, QUICK_CROWDS) if given.quick else (HORIZONS, CROWDS)
    over_horizon, over_people = measure(horizons, passes), measure(crowds, passes)
    many = [case for case in crowds if case.pedestrians >= FEWEST_PEOPLE]
    found: dict[str, Any] = {
        "horizon": over_horizon,
        "pedestrians": over_people,
        "horizon_exponent": exponents([case.steps for case in horizons], list(over_horizon.values())),
        "pedestrians_exponent": exponents(
            [case.pedestrians for case in many], [over_people[str(case)] for case in many]
        ),
        "fewest_people": FEWEST_PEOPLE,
    }
    for name in ("horizon", "pedestrians"):
        for case, entry in found[name].items():
            shown = "  ".join(
                f"{solver} {one['median_ms']:.2f} (mean {one['mean_ms']:.2f}) ms"
                for solver, one in entry.items()
            )
            print(f"{case:7}{shown}")
        for solver, k in found[f"{name}_exponent"].items():
            print(f"{solver}: cost ~ {name}^{k['median_ms']:.2f} (median), ^{k['mean_ms']:.2f} (mean)")
    results.publish("growth", found, (), given.folder)


if __name__ == "__main__":
    main()
