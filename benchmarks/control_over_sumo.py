"""Where the time of a run with SUMO goes: sensing, control, SUMO's own step, recording; in one loop.

Run with ``make bench``. SUMO is measured inside the loop because its step slows down when its caches have
gone cold in between.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import libsumo
from control_step import solvers
from measuring import results
from measuring.stopwatch import Stopwatch, watching

from controllers.interface import Controller, Decision, Perception, Plan
from cosim import loop
from cosim.compose import compose
from cosim.recorder import Recorder
from cosim.request import RunRequest

SCENARIO = "midblock_zebra"
DRIVEN = 60.0
"""Simulated time after the warm-up [s]."""
SUMO, SENSE, CONTROL, ACT, RECORD = "SUMO's step", "sense", "decide + plan", "act + advance", "record"
PARTS = (SENSE, CONTROL, ACT, SUMO, RECORD)


class _TimedDrivers(Mapping[str, Controller]):
    """The drivers of a run, their controllers' time counted."""

    def __init__(self, drivers: Mapping[str, Controller], watch: Stopwatch) -> None:
        self._drivers, self._watch = drivers, watch

    def __getitem__(self, name: str) -> Controller:
        return _TimedDriver(self._drivers[name], self._watch)

    def __iter__(self) -> Iterator[str]:
        return iter(self._drivers)

    def __len__(self) -> int:
        return len(self._drivers)


@dataclass(frozen=True, slots=True)
class _TimedDriver:
    driver: Controller
    watch: Stopwatch

    def decide(self, perception: Perception) -> Decision:
        with self.watch.part(CONTROL):
            return self.driver.decide(perception)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        with self.watch.part(CONTROL):
            return self.driver.plan(perception, decision)


def drive(solver: str, pedestrians_per_hour: int = 600) -> dict[str, Any]:
    """Return the mean times per step of one run [ms], and how much traffic there was."""
    settings = {"solver": solver, "steps": "30", "pedestrians_per_hour": str(pedestrians_per_hour)}
    warmup_s = _warmup_s()
    composition = compose(RunRequest(SCENARIO, seed=7, settings=settings, duration_s=warmup_s + DRIVEN))
    watch = Stopwatch()
    counts = {"vehicles": 0, "persons": 0, "plans": 0}
    with TemporaryDirectory() as folder:
        try:
            world = composition.world
            world.sense()  # warms up
            with Recorder(Path(folder)) as recorder:
                kind, record = type(world), type(recorder)
                places = (
                    (kind, "sense", SENSE),
                    (kind, "act", ACT),
                    (kind, "advance", ACT),
                    (kind, "snapshot", SENSE),
                    (record, "planned", RECORD),
                    (record, "stepped", RECORD),
                    (libsumo, "simulationStep", SUMO),
                )

                def count(time: float) -> None:
                    counts["vehicles"] += libsumo.vehicle.getIDCount()
                    counts["persons"] += libsumo.person.getIDCount()

                with watching(watch, places):
                    times = loop.run(
                        world, _TimedDrivers(composition.drivers, watch), recorder, after_step=count
                    )
        finally:
            composition.close()
    per_step = {part: 1e3 * watch.seconds.get(part, 0.0) / times.steps for part in PARTS}
    return {
        "steps": times.steps,
        "step_s": composition.inputs.step_s,
        "vehicles": counts["vehicles"] / times.steps,
        "persons": counts["persons"] / times.steps,
        "egos_per_step": watch.calls.get(CONTROL, 0) / 2 / times.steps,
        "ms_per_step": per_step,
        "control_over_sumo": per_step[CONTROL] / per_step[SUMO],
        "sense_over_sumo": per_step[SENSE] / per_step[SUMO],
    }


def _warmup_s() -> float:
    composition = compose(RunRequest(SCENARIO, controller="constant_speed"))
    try:
        return float(composition.inputs.warmup_s)
    finally:
        composition.close()


def main() -> None:
    """Measure with each solver, print and publish."""
    found = {solver: drive(solver) for solver in solvers()}
    for solver, entry in found.items():
        shares = "  ".join(f"{part} {value:.3f}" for part, value in entry["ms_per_step"].items())
        print(f"{SCENARIO} {solver}: {entry['egos_per_step']:.2f} egos a step; mean ms per step: {shares}")
        print(
            f"  control over SUMO's own step: {entry['control_over_sumo']:.1f}; "
            f"sense over SUMO's own step: {entry['sense_over_sumo']:.2f}"
        )
    first = next(iter(found.values()))
    common = {key: first[key] for key in ("steps", "step_s", "vehicles", "persons")}
    results.publish("control_over_sumo", {"scenario": SCENARIO, **common, "solvers": found})


if __name__ == "__main__":
    main()
