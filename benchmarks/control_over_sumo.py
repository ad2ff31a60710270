"""What one controlled car costs beside SUMO's own work: sense to act, over ``world.advance()``.

Both are measured inside one loop, because SUMO's step slows down when its caches have gone cold in between.
The repeats take turns.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gc
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from measuring import results
from measuring.bars import Bar, show
from measuring.city import FILLED_S, City
from measuring.command import options
from measuring.control_parts import PARTS as CONTROL_PARTS
from measuring.loop_with_sumo import ACT, ADVANCE, CONTROL, RECORD, SENSE, SNAPSHOT, SUMO, Drive, alone, drive
from measuring.solvers import SOLVERS

from cosim.running.request import RunRequest

EGO = "car.0"
HORIZON = 30
DRIVEN_S = 30.0
CITIES = ((50, 20), (200, 200), (1000, 200))
"""Vehicles and persons."""
REPEATS = {50: 5, 200: 5, 1000: 3}
BARRED = (200, 200)
MOST = {"daqp": 1.0, "osqp": 1.0}
OF_THE_LOOP = (SENSE, CONTROL, ACT, ADVANCE, SUMO, SNAPSHOT, RECORD)


def measure(vehicles: int, persons: int, repeats: int, driven_s: float) -> dict[str, Any]:
    """Return times and ratios of one city, by solver."""
    until_s = FILLED_S + driven_s
    with TemporaryDirectory() as folder:
        configuration = City(vehicles, persons, duration_s=until_s).write(Path(folder))
        requests = {solver: _request(configuration, solver) for solver in SOLVERS}
        drives: dict[str, list[Drive]] = {solver: [] for solver in requests}
        without: list[float] = []
        for number in range(repeats):
            names = list(requests) if number % 2 == 0 else list(reversed(requests))
            for solver in names:
                drives[solver].append(drive(requests[solver], FILLED_S))
                gc.collect()
            without.append(1e3 * float(np.mean(alone(configuration, FILLED_S, until_s))))
        split = {solver: drive(requests[solver], FILLED_S, by_part=True) for solver in requests}
    first = next(iter(drives.values()))[0]
    return {
        "steps": first.steps,
        "step_s": first.step_s,
        "vehicles": float(np.mean(first.vehicles)),
        "persons": float(np.mean(first.persons)),
        "sumo_alone_ms": float(np.median(without)),
        "solvers": {solver: _summary(drives[solver], without, split[solver]) for solver in requests},
    }


def _request(configuration: Path, solver: str) -> RunRequest:
    settings = {"solver": solver, "steps": str(HORIZON)}
    return RunRequest(str(configuration), ego_vehicle=EGO, settings=settings, actuation="hybrid")


def _summary(drives: Sequence[Drive], without: Sequence[float], split: Drive) -> dict[str, Any]:
    means = [one.mean_ms(OF_THE_LOOP) for one in drives]
    control = np.array([one[SENSE] + one[CONTROL] + one[ACT] for one in means])
    advance = np.array([one[ADVANCE] + one[SUMO] for one in means])
    parts = (SENSE, *CONTROL_PARTS, ACT, ADVANCE, SUMO, RECORD)
    return {
        "egos_per_step": float(np.mean([np.mean(one.egos) for one in drives])),
        "ms_per_step": {part: float(np.median([one[part] for one in means])) for part in OF_THE_LOOP},
        "control_over_advance": _spread(control / advance),
        "control_over_sumo": _spread(control / np.array([one[SUMO] for one in means])),
        "control_over_sumo_alone": _spread(control / np.array(without)),
        "parts": split.watch.spread(parts),
    }


def _spread(values: np.ndarray) -> dict[str, float]:
    return {"median": float(np.median(values)), "least": float(values.min()), "most": float(values.max())}


def report(name: str, entry: dict[str, Any]) -> None:
    """Print one city."""
    print(f"{name}: SUMO without an ego {entry['sumo_alone_ms']:.3f} ms a step", flush=True)
    for solver, one in entry["solvers"].items():
        shares = "  ".join(f"{part} {value:.3f}" for part, value in one["ms_per_step"].items())
        ratio = one["control_over_advance"]
        print(
            f"  {solver}: mean ms per step: {shares}; control over advance {ratio['median']:.2f} "
            f"({ratio['least']:.2f} to {ratio['most']:.2f}), over SUMO without an ego "
            f"{one['control_over_sumo_alone']['median']:.2f}",
            flush=True,
        )


def bars(found: dict[str, Any]) -> list[Bar]:
    """Return what is asked of one ego."""
    name = f"{BARRED[0]}/{BARRED[1]}"
    if name not in found:
        return []
    return [
        Bar(
            what=f"one ego, sense to act over world.advance(), {name}, {solver}",
            measured=one["control_over_advance"]["median"],
            at_most=MOST[solver],
            unit="",
            note=f"{one['control_over_advance']['least']:.2f} to {one['control_over_advance']['most']:.2f}; "
            f"over SUMO's step without an ego {one['control_over_sumo_alone']['median']:.2f}",
        )
        for solver, one in found[name]["solvers"].items()
    ]


def main() -> None:
    """Measure with each solver, print and publish."""
    given = options(__doc__)
    found = {}
    for vehicles, persons in CITIES[:1] if given.quick else CITIES:
        repeats, driven_s = (1, 3.0) if given.quick else (REPEATS[vehicles], DRIVEN_S)
        name = f"{vehicles}/{persons}"
        found[name] = measure(vehicles, persons, repeats, driven_s)
        report(name, found[name])
    asked = bars(found)
    show(asked)
    results.publish("control_over_sumo", {"horizon": HORIZON, "cities": found}, asked, given.folder)


if __name__ == "__main__":
    main()
