"""A run with SUMO, its time by part: cosim's own loop, and SUMO alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import libsumo

from controllers.interface import Controller, Decision, Perception, Plan
from cosim.recording.recorder import Recorder
from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.step import loop
from measuring.control_parts import Programs, observed
from measuring.stopwatch import OTHER, Stopwatch, watching
from sumo_scenarios import library

SENSE, ACT, ADVANCE, SNAPSHOT, RECORD = "sense", "act", "advance", "snapshot", "record"
SEED = 1
"""Of SUMO where it runs alone; requests have the same by default."""
CONTROL = OTHER
"""Decide and plan; a share of it counts under its own parts when they are watched."""
SUMO = "SUMO's step"
"""Within ``advance``."""


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


@dataclass(slots=True)
class Drive:
    """What a run took, from a given time on."""

    step_s: float
    watch: Stopwatch
    egos: list[int] = field(default_factory=list)
    """Egos that planned, by step."""
    vehicles: list[int] = field(default_factory=list)
    persons: list[int] = field(default_factory=list)
    wall_s: float = 0.0
    """Everything, recording included."""

    @property
    def steps(self) -> int:
        """Steps that were counted."""
        return len(self.vehicles)

    def mean_ms(self, parts: Sequence[str]) -> dict[str, float]:
        """Return the mean time of a step by part [ms]."""
        steps = self.watch.steps
        return {part: 1e3 * sum(step.get(part, 0.0) for step in steps) / len(steps) for part in parts}


def drive(request: RunRequest, after_s: float, by_part: bool = False) -> Drive:
    """Run, and count what happens after ``after_s``.

    Parameters
    ----------
    request : what to run
    after_s : simulated time before which nothing counts
    by_part : also split the controllers' time, at the price of the clock's own cost
    """
    composition = compose(request)
    watch = Stopwatch()
    found = Drive(composition.inputs.step_s, watch)
    egos = 0
    began: float | None = None
    with TemporaryDirectory() as folder:
        try:
            world = composition.world
            with Recorder(Path(folder)) as recorder, ExitStack() as stack:
                kind, record = type(world), type(recorder)
                places = (
                    (kind, "sense", SENSE),
                    (kind, "act", ACT),
                    (kind, "advance", ADVANCE),
                    (kind, "snapshot", SNAPSHOT),
                    (record, "planned", RECORD),
                    (record, "stepped", RECORD),
                    (libsumo, "simulationStep", SUMO),
                )

                def after_step(time: float) -> None:
                    nonlocal egos, began
                    if time <= after_s:
                        began = perf_counter()
                        watch.end_step()
                        watch.steps.pop()
                        egos = watch.calls.get(CONTROL, 0)
                        return
                    watch.end_step()
                    found.egos.append((watch.calls.get(CONTROL, 0) - egos) // 2)
                    egos = watch.calls.get(CONTROL, 0)
                    found.vehicles.append(libsumo.vehicle.getIDCount())
                    found.persons.append(libsumo.person.getIDCount())

                stack.enter_context(watching(watch, places))
                if by_part:
                    stack.enter_context(observed(Programs(), watch))
                loop.run(world, _TimedDrivers(composition.drivers, watch), recorder, after_step=after_step)
                found.wall_s = perf_counter() - began if began is not None else 0.0
        finally:
            composition.close()
    return found


def alone(configuration: Path, after_s: float, until_s: float) -> list[float]:
    """Return what each step of SUMO takes without an ego and without being asked anything [s]."""
    times = []
    with TemporaryDirectory() as folder:
        options = library.prepare(library.load(str(configuration)), SEED, Path(folder)).options
        libsumo.start(["sumo", *options])
    try:
        while libsumo.simulation.getTime() < until_s:
            began = perf_counter()
            libsumo.simulationStep()
            took = perf_counter() - began
            if libsumo.simulation.getTime() > after_s:
                times.append(took)
    finally:
        libsumo.close()
    return times
