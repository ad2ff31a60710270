"""The step: sense, decide, plan, act, advance, record. Knows no simulator and no controller by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol

import numpy as np

from controllers.interface import Command, Controller, Decision, FloatArray, Perception, Plan
from cosim.errors import CosimError, SimulationError
from cosim.world import Snapshot, World

ToWorld = Callable[[str, FloatArray, FloatArray], FloatArray]


class Record(Protocol):
    """What the step tells about itself."""

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Take note of one ego's plan, made at the beginning of a step."""
        ...

    def stepped(self, snapshot: Snapshot) -> None:
        """Take note of the world after the step."""
        ...


@dataclass(slots=True)
class LoopTimes:
    """Wall-clock time that a loop has used so far, apart from recording [s]."""

    steps: int = 0
    control: float = 0.0
    world: float = 0.0

    @property
    def control_over_world(self) -> float | None:
        """Time of all controllers over the world's own; ``None`` before the first step."""
        return self.control / self.world if self.world > 0.0 else None


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
        What is driven in; senses one perception for each ego that is to plan now, perhaps none.
    drivers : Mapping
        Ego name to controller; may build controllers at the first look-up.
    record : Record
        Receives every plan and every snapshot.
    times : LoopTimes
        Added to in place, so that the caller keeps it when the run fails.
    after_step : Callable
        Called with the simulated time [s] after every step.

    Raises
    ------
    SimulationError
        When a controller fails or commands something that is not a finite number.
    """
    times = LoopTimes() if times is None else times
    # The first sensing is not counted: a world may warm up in it.
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
    return times


def _driver(drivers: Mapping[str, Controller], perception: Perception) -> Controller:
    try:
        return drivers[perception.ego.name]
    except KeyError:
        raise SimulationError(
            f"nobody drives ego {perception.ego.name!r}, which appeared at {perception.ego.time:.2f} s"
        ) from None


def _answer(driver: Controller, perception: Perception) -> tuple[Decision, Plan]:
    """Return the controller's decision and plan; whatever goes wrong inside it ends the run by name."""
    ego = perception.ego
    try:
        decision = driver.decide(perception)
        plan = driver.plan(perception, decision)
    except CosimError:
        raise
    except Exception as error:  # a plug-in may raise anything; re-raised with its place
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
    return bool(
        np.isfinite(command.times).all()
        and np.isfinite(command.acceleration).all()
        and np.isfinite(command.steering).all()
    )
