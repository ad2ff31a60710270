"""How many cars can be controlled at once: real-time factor and cost per ego, in one network.

Each number of egos is driven in a process of its own, on one core.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from measuring import results
from measuring.bars import Bar, show
from measuring.city import FILLED_S, City
from measuring.command import options
from measuring.loop_with_sumo import ACT, ADVANCE, CONTROL, RECORD, SENSE, SNAPSHOT, SUMO, drive
from measuring.solvers import DEFAULT

from cosim.running.request import RunRequest
from cosim.sumo.egos import drawn

VEHICLES, PERSONS = 400, 200
DRIVEN_S = 10.0
EGOS = (1, 10, 50, 100, 200)
BARRED = 100
SEED = 1
PARTS = (SENSE, CONTROL, ACT, ADVANCE, SUMO, SNAPSHOT, RECORD)


def in_child(city: City, egos: int, solver: str) -> dict[str, Any]:
    """Drive that many egos in a process of its own."""
    with TemporaryDirectory() as folder:
        configuration = city.write(Path(folder))
        share = str(share_of(egos, city.vehicles))
        command = [sys.executable, __file__, "--drive", str(configuration), share, solver]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"{egos} egos with {solver}: the run ended with {done.returncode}")
    return dict(json.loads(done.stdout.splitlines()[-1]))


def share_of(egos: int, vehicles: int) -> float:
    """Return a share of which so many cars are egos: each has a number that is drawn from its name."""
    numbers = sorted(drawn(SEED, f"car.{number}") for number in range(vehicles))
    return 0.5 * (numbers[egos - 1] + numbers[egos])


def measured(configuration: str, share: float, solver: str) -> dict[str, Any]:
    """Return what a run takes per step and ego, on one core."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    settings = {"solver": solver}
    request = RunRequest(configuration, "vo_mpc", SEED, settings, actuation="hybrid", ego_share=share)
    found = drive(request, FILLED_S)
    simulated_s = found.steps * found.step_s
    per_step = found.mean_ms(PARTS)
    egos = float(np.mean(found.egos))
    return {
        "solver": solver,
        "share": share,
        "egos": egos,
        "vehicles": float(np.mean(found.vehicles)),
        "persons": float(np.mean(found.persons)),
        "steps": found.steps,
        "real_time_factor": simulated_s / found.wall_s,
        "ms_per_step": per_step,
        "ms_per_ego_and_step": 1e3 * found.wall_s / found.steps / max(egos, 1.0),
        "control_ms_per_ego_and_step": (per_step[SENSE] + per_step[CONTROL] + per_step[ACT]) / max(egos, 1.0),
    }


def report(entry: dict[str, Any]) -> None:
    """Print one run."""
    parts = "  ".join(f"{part} {value:.1f}" for part, value in entry["ms_per_step"].items())
    print(
        f"{entry['egos']:5.1f} egos among {entry['vehicles']:.0f} vehicles and {entry['persons']:.0f} "
        f"persons, {entry['solver']}: {entry['real_time_factor']:.2f} x real time; "
        f"{entry['control_ms_per_ego_and_step']:.2f} ms of control per ego and step; ms per step: {parts}",
        flush=True,
    )


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--drive"]:
        print(json.dumps(measured(sys.argv[2], float(sys.argv[3]), sys.argv[4])))
        return
    given = options(__doc__)
    asked_for = [(2, DEFAULT)] if given.quick else [*((egos, DEFAULT) for egos in EGOS), (BARRED, "osqp")]
    city = (
        City(20, 10, duration_s=FILLED_S + 2.0)
        if given.quick
        else City(VEHICLES, PERSONS, duration_s=FILLED_S + DRIVEN_S)
    )
    runs = []
    for egos, solver in asked_for:
        runs.append({"asked_for": egos, **in_child(city, egos, solver)})
        report(runs[-1])
    bars = [
        Bar(
            what=f"{run['asked_for']} egos among {VEHICLES} vehicles and {PERSONS} persons on one core, "
            f"{run['solver']}",
            measured=run["real_time_factor"],
            at_least=1.0,
            unit="x real time",
            note=f"{run['egos']:.0f} egos",
        )
        for run in runs
        if run["asked_for"] == BARRED and run["solver"] == DEFAULT
    ]
    show(bars)
    results.publish("many_egos", {"runs": runs}, bars, given.folder)


if __name__ == "__main__":
    main()
