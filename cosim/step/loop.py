"""The step: sense, decide, plan, act, advance, record. It knows no simulator and no controller by name."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from math import isfinite
from time import perf_counter
from typing import Protocol

import numpy as np

from controllers.interface import Command, Controller, Decision, Perception, Plan
from cosim.arrays import FloatArray
from cosim.errors import CosimError, SimulationError
from cosim.step.world import Snapshot, World

ToWorld = Callable[[str, FloatArray, FloatArray], FloatArray]

_NEW_OBJECTS = 20_000
"""Garbage is collected after this many new objects; one ego makes more than Python's own 700 in a step."""


class Record(Protocol):
    """Receives the events of the step."""

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Record one ego's plan, made at the beginning of a step."""
        ...

    def stepped(self, snapshot: Snapshot) -> None:
        """Record the world after the step."""
        ...


@dataclass(slots=True)
class LoopTimes:
    """Wall-clock time that a loop has used so far, apart from recording [s]."""

    steps: int = 0
    control: float = 0.0
    world: float = 0.0


def run(
    world: World,
    drivers: Mapping[str, Controller],
    record: Record,
    times: LoopTimes | None = None,
    after_step: Callable[[float], None] = lambda time: None,
) -> LoopTimes:
    """Drive every ego of the world until the world says that the run is over.

    Parameters
    ----------
    world : World
        The world to drive in; it senses one perception for each ego that has to plan now, perhaps none.
    drivers : Mapping
        Ego name to controller; may build controllers at the first look-up.
    record : Record
        Receives every plan and every snapshot.
    times : LoopTimes
        Updated in place, so that the caller has the times even if the run fails.
    after_step : Callable
        Called with the simulated time [s] after every step.

    Raises
    ------
    SimulationError
        When a controller fails or commands something that is not a finite number.
    """
    times = LoopTimes() if times is None else times
    with rarely_collected():
        _drive(world, drivers, record, times, after_step)
    return times


def _drive(
    world: World,
    drivers: Mapping[str, Controller],
    record: Record,
    times: LoopTimes,
    after_step: Callable[[float], None],
) -> None:
    # The first sensing is not counted, because a world may warm up in it.
    started: float | None = None
    while (perceptions := world.sense()) is not None:
        if started is not None:
            times.world += perf_counter() - started
        for perception in perceptions:
            name = perception.ego.name
            driver = _driver(drivers, perception)
            began = perf_counter()
            decision, plan = _answer(driver, perception)
            compute_s = perf_counter() - began
            times.control += compute_s
            world.act(name, plan.command)
            record.planned(perception, decision, plan, compute_s, world.to_world)
        started = perf_counter()
        world.advance()
        snapshot = world.snapshot()
        times.world += perf_counter() - started
        times.steps += 1
        record.stepped(snapshot)
        after_step(snapshot.time)
        started = perf_counter()


def _driver(drivers: Mapping[str, Controller], perception: Perception) -> Controller:
    try:
        return drivers[perception.ego.name]
    except KeyError:
        raise SimulationError(
            f"nobody drives ego {perception.ego.name!r}, which appeared at {perception.ego.time:.2f} s"
        ) from None


def _answer(driver: Controller, perception: Perception) -> tuple[Decision, Plan]:
    """Return the controller's decision and plan; any failure ends the run with an error naming the ego."""
    ego = perception.ego
    try:
        decision = driver.decide(perception)
        plan = driver.plan(perception, decision)
    except CosimError:
        raise
    except (Exception, SystemExit) as error:  # a plug-in may raise anything; re-raised with its place
        what = f"{type(error).__name__}: {error}".replace("\n", " ")
        raise SimulationError(
            f"the controller of ego {ego.name!r} failed at {ego.time:.2f} s: {what}"
        ) from error
    if not _is_finite(plan.command):
        raise SimulationError(
            f"the controller of ego {ego.name!r} commanded a value that is not a finite number "
            f"at {ego.time:.2f} s (plan status {plan.status!r})"
        )
    return decision, plan


def _is_finite(command: Command) -> bool:
    values = (command.times, command.acceleration, command.steering)
    return all(all(map(isfinite, np.asarray(column).tolist())) for column in values)


@contextmanager
def rarely_collected() -> Iterator[None]:
    """Make Python collect garbage rarely: a step makes thousands of objects, but hardly any garbage.

    The world and its network, a hundred thousand objects that stay, are then hardly ever searched.
    """
    before = gc.get_threshold()
    gc.set_threshold(_NEW_OBJECTS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
