"""Whether the short cuts change what happens: closed-loop safety on the same seeds, with and without them.

With: the optimum is looked for near the last active rows, a solver begins with a few rows, all are verified.
Without: every program goes to the solver, with all its rows at once.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pyarrow.parquet as pq
from measuring import results, solvers
from measuring.bars import Bar, show
from measuring.command import options
from measuring.control_parts import Programs, observed
from measuring.stopwatch import replaced

from analysis.statistics.paired import compare_values
from controllers.mpc import driver
from controllers.programs import qp
from cosim.execution import execute
from cosim.request import RunRequest

CONTROLLER = "vo_mpc"
SCENARIOS = {"midblock_zebra": 18, "jaywalk_arterial": 17}
"""Numbers of seeds. Not `midblock_unmarked`: there pedestrians wait until the ego has passed, so that a time
to collision hardly ever arises."""
LEAST_PAIRS = 10
"""With fewer pairs an interval says nothing, also where all its differences are 0."""
WARMUP_S, DRIVEN_S = 20.0, 60.0
MEASURES = {"min_ttc_s": "s", "min_pet_s": "s", "ego_delay_mean_s": "s"}
COLUMNS = ["time_s", "ego_id", "front_x_m", "front_y_m"]
ALL_ROWS = 10**6
ALWAYS = -1
"""No look near the last active rows."""


def drive(scenario: str, seed: int, solver: str, short_cuts: bool) -> dict[str, Any]:
    """Return a run's measures and where its egos were."""
    programs = Programs()
    with TemporaryDirectory() as folder, ExitStack() as stack:
        if not short_cuts:
            # Programs are shared between runs; those of this one are made after this, and for it alone.
            driver.forget_programs()
            stack.callback(driver.forget_programs)
            stack.enter_context(replaced(qp, "CHANGES", {solvers.settings(solver)["solver"]: ALWAYS}))
            stack.enter_context(replaced(qp, "COMPILED_CHANGES", ALWAYS))
            stack.enter_context(replaced(qp, "FIRST_ROWS", ALL_ROWS))
        stack.enter_context(observed(programs))
        settings = {**solvers.given(solver), "warmup_s": f"{WARMUP_S:g}"}
        duration_s, out = WARMUP_S + DRIVEN_S, Path(folder) / "run"
        outcome = execute(RunRequest(scenario, CONTROLLER, seed, settings, duration_s=duration_s, out=out))
        if outcome.row is None:
            raise SystemExit(f"{scenario}, seed {seed}: {outcome.invalid_reason or 'nothing to analyse'}")
        egos = pq.read_table(outcome.folder / "egos.parquet", columns=COLUMNS)
    near = programs.near
    if not short_cuts and near:
        raise SystemExit(f"{near} programs of the full runs were settled without the solver")
    return {
        "row": {key: outcome.row.get(key, "") for key in MEASURES},
        "egos": egos.to_pydict(),
        "programs": near + programs.solver,
    }


def apart(one: dict[str, Any], other: dict[str, Any]) -> float:
    """Return the largest distance between the same ego at the same time in two runs [m]."""
    places = [
        {(t, ego): (x, y) for t, ego, x, y in zip(*(run["egos"][key] for key in run["egos"]), strict=True)}
        for run in (one, other)
    ]
    shared = places[0].keys() & places[1].keys()
    return max((float(np.hypot(*np.subtract(places[0][key], places[1][key]))) for key in shared), default=0.0)


def compared(pairs: list[tuple[dict[str, Any], dict[str, Any]]]) -> dict[str, dict[str, Any]]:
    """Return differences (with short cuts minus without) and their 95 % intervals, by measure."""
    found = {}
    for key, unit in MEASURES.items():
        both = [
            (float(full["row"][key]), float(short["row"][key]))
            for short, full in pairs
            if full["row"][key] and short["row"][key]
        ]
        base, alt = (np.array(values) for values in zip(*both, strict=True)) if both else (np.empty(0),) * 2
        answer = compare_values(base, alt)
        # Equal differences have no interval of their own: it is that one number.
        exact = answer.difference
        low, high = (
            (answer.interval.low, answer.interval.high)
            if answer.interval is not None
            else (exact, exact)
            if exact is not None
            else (float("nan"),) * 2
        )
        found[key] = {
            "unit": unit,
            "pairs": answer.pairs,
            "mean": answer.base_mean,
            "difference": answer.difference,
            "low": low,
            "high": high,
            "largest": float(np.abs(alt - base).max()) if len(base) else None,
        }
    return found


def judged(scenario: str, key: str, one: Mapping[str, Any]) -> Bar:
    """Return the bar of one measure: no difference is within its interval, which has enough pairs."""
    too_few = one["pairs"] < LEAST_PAIRS
    told = f"{one['difference']:+.1e}, interval {one['high'] - one['low']:.1e} wide, " if one["pairs"] else ""
    return Bar(
        what=f"{scenario}, {key}, with short cuts minus without: distance of 0 from its 95 % interval",
        measured=max(one["low"], -one["high"], 0.0) if one["pairs"] else float("nan"),
        at_most=0.0,
        unit=one["unit"],
        note=f"{told}{one['pairs']} pairs",
        undecided=f"too few pairs, {LEAST_PAIRS} expected" if too_few else "",
    )


def main() -> None:
    """Measure, print and publish."""
    given = options(__doc__)
    solver = solvers.solvers()[-1]
    scenarios = {next(iter(SCENARIOS)): 2} if given.quick else SCENARIOS
    found: dict[str, Any] = {"solver": solver, "driven_s": DRIVEN_S, "scenarios": {}}
    bars = []
    for scenario, count in scenarios.items():
        seeds = range(1, count + 1)
        pairs = [
            (drive(scenario, seed, solver, True), drive(scenario, seed, solver, False)) for seed in seeds
        ]
        entry = {
            "seeds": list(seeds),
            "programs": sum(short["programs"] for short, _ in pairs),
            "apart_m": max(apart(*pair) for pair in pairs),
            "measures": compared(pairs),
        }
        found["scenarios"][scenario] = entry
        print(f"{scenario}: {len(pairs)} pairs, egos at most {entry['apart_m']:.1e} m apart")
        bars += [judged(scenario, key, one) for key, one in entry["measures"].items()]
    show(bars)
    results.publish("screening", found, bars, given.folder)


if __name__ == "__main__":
    main()
