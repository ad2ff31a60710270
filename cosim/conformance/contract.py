"""The contract that every controller has to keep: the checks behind ``cosim conformance --controller``.

The contract tests of the catalogue call the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from statistics import median, quantiles
from time import perf_counter

import numpy as np

from controllers.interface import Command, Controller, Decision, Perception, Plan
from cosim.conformance.scenes import ego, golden, perception, straight_road
from cosim.step.drivers import release
from cosim.step.loop import ToWorld, run
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot

Factory = Callable[[], Controller]
"""Function that makes a new controller, as for another ego or another run."""
Answer = tuple[Decision, Plan]

CROWD = "five hundred pedestrians"
INTERVALS = (0.05, 0.25, 1.0)
"""Plan intervals [s]."""
SPEEDS = (0.0, 0.01, 40.0)
"""Extreme speeds of the ego [m/s]."""
SLOWEST_MS = 100.0
"""Longest allowed median time of a step, equal to the plan interval of most scenarios [ms]."""
_ROUNDING = 1e-6


class BrokenError(AssertionError):
    """Part of the contract that is not kept; the message is one line."""


@contextmanager
def made(factory: Factory) -> Iterator[Controller]:
    """Make a new controller, and release it at the end."""
    controller = factory()
    try:
        yield controller
    finally:
        release(controller)


def answers(controller: Controller, scenes: Sequence[Perception]) -> list[Answer]:
    """Return a controller's answers to consecutive scenes."""
    return [answer(controller, scene) for scene in scenes]


def answer(controller: Controller, scene: Perception) -> Answer:
    """Return a controller's decision and plan for a scene."""
    decision = controller.decide(scene)
    return decision, controller.plan(scene, decision)


def moments(scene: Perception, count: int = 3) -> list[Perception]:
    """Repeat a scene over a few plan intervals, so that a controller uses its memory."""
    interval = scene.ego.plan_interval
    return [replace(scene, ego=replace(scene.ego, time=index * interval)) for index in range(count)]


def in_a_row(scenes: Mapping[str, Perception]) -> list[Perception]:
    """Return all situations as consecutive moments for one controller object, with the crowd last."""
    ordered = [scene for situation, scene in scenes.items() if situation != CROWD] + [scenes[CROWD]]
    return [replace(scene, ego=replace(scene.ego, time=0.1 * index)) for index, scene in enumerate(ordered)]


def check_possible(command: Command, scene: Perception) -> None:
    """Check that a command can be carried out.

    Raises
    ------
    BrokenError
        If its times do not ascend from 0, its columns differ in length, or a value is not finite or exceeds
        what the actuators can do.
    """
    drive = scene.ego.drive
    columns = (command.times, command.acceleration, command.steering)
    if not len(command.times) == len(command.acceleration) == len(command.steering) >= 1:
        raise BrokenError(f"a command has columns of lengths {', '.join(str(len(one)) for one in columns)}")
    if not all(np.isfinite(one).all() for one in columns):
        raise BrokenError("a command has a value that is not a finite number")
    if abs(command.times[0]) > 1e-9 or not (np.diff(command.times) > 0.0).all():
        raise BrokenError("the times of a command do not ascend from 0")
    for name, values, low, high in (
        ("acceleration", command.acceleration, -drive.max_deceleration, drive.max_acceleration),
        ("steering", command.steering, -drive.max_steering, drive.max_steering),
    ):
        worst = float(values[np.argmax(np.abs(values))])
        if values.min() < low - _ROUNDING or values.max() > high + _ROUNDING:
            raise BrokenError(f"{name} {worst:.3g} is beyond what the vehicle can do, {low:g} to {high:g}")


def check_answer(given: Answer, scene: Perception) -> None:
    """Check a decision and a plan.

    Raises
    ------
    BrokenError
        For a command that cannot be carried out, a lane that does not exist, a path whose columns differ in
        length, or a fallback without a name.
    """
    decision, plan = given
    check_possible(plan.command, scene)
    if not isinstance(decision.target_lane, int) or scene.road.lane(decision.target_lane) is None:
        raise BrokenError(f"the target lane {decision.target_lane!r} does not exist")
    if not len(plan.along) == len(plan.across) == len(plan.speed) == len(plan.times):
        raise BrokenError("the columns of a planned path have different lengths")
    if not plan.solved and plan.status in ("", "ok"):
        raise BrokenError(f"a step without the wanted plan has the status {plan.status!r}: expected a name")


def check_same(first: Sequence[Answer], second: Sequence[Answer]) -> None:
    """Check that two series of answers are identical, to the last digit.

    Raises
    ------
    BrokenError
        If they differ; the message names the first difference.
    """
    for number, ((wanted, plan), (again, other)) in enumerate(zip(first, second, strict=True), 1):
        told = f"in step {number} of {len(first)}"
        if wanted != again:
            raise BrokenError(f"{told} the decisions differ: {wanted} and {again}")
        if (plan.status, plan.solved, plan.passing) != (other.status, other.solved, other.passing):
            raise BrokenError(f"{told} the plans differ: {plan.status!r} and {other.status!r}")
        for name in ("times", "acceleration", "steering"):
            if not np.array_equal(getattr(plan.command, name), getattr(other.command, name)):
                raise BrokenError(f"{told} the commands differ in {name}")


def check_situation(factory: Factory, situation: str) -> str:
    """Check the answers to a golden scene over a few moments; return how many of them were fallbacks."""
    scene = golden()[situation]
    with made(factory) as controller:
        given = answers(controller, moments(scene))
    for one in given:
        check_answer(one, scene)
    unsolved = sum(not plan.solved for _, plan in given)
    return f"{unsolved} of {len(given)} steps with a fallback" if unsolved else ""


def check_interval(factory: Factory, interval: float, situations: Sequence[str] = ()) -> str:
    """Check commands for a plan interval of this length [s], by default in all situations but the crowd."""
    scenes = golden()
    for situation in situations or [one for one in scenes if one != CROWD]:
        scene = scenes[situation]
        seen = replace(scene, ego=replace(scene.ego, plan_interval=interval))
        with made(factory) as controller:
            _, plan = answer(controller, seen)
        check_possible(plan.command, seen)
    return ""


def check_speed(factory: Factory, speed: float) -> str:
    """Check the commands at an extreme speed [m/s]."""
    scene = perception(ego(speed), straight_road(3, 1))
    with made(factory) as controller:
        for _, plan in answers(controller, moments(scene)):
            check_possible(plan.command, scene)
    return ""


def check_survival(factory: Factory) -> str:
    """Check the commands of one controller object that meets all situations in turn."""
    scenes = in_a_row(golden())
    with made(factory) as controller:
        for (_, plan), scene in zip(answers(controller, scenes), scenes, strict=True):
            check_possible(plan.command, scene)
    return f"{len(scenes)} situations"


def check_determinism(factory: Factory) -> str:
    """Check that the same perceptions give the same answers, even if another object answers in between."""
    scenes = in_a_row(golden())[:-1]
    with made(factory) as controller:
        alone = answers(controller, scenes)
    with made(factory) as controller, made(factory) as other:
        again = []
        for index, scene in enumerate(scenes):
            if index % 3 == 0:
                answer(other, scenes[-1 - index])
            again.append(answer(controller, scene))
    check_same(alone, again)
    return f"{len(scenes)} steps"


def check_runs(factory: Factory) -> str:
    """Check that a second run without SUMO repeats the first: no state is carried over between runs."""
    first, second = _drive(factory), _drive(factory)
    if first.rows != second.rows:
        raise BrokenError("two runs of the same scene differ")
    return f"{len(first.rows)} steps, {first.travelled:.0f} m"


def check_time(factory: Factory) -> str:
    """Check that a step is fast enough, and return the median and 99th percentile of its time."""
    scenes = in_a_row(golden())[:-1]
    times = []
    with made(factory) as controller:
        for scene in scenes:
            begun = perf_counter()
            answer(controller, scene)
            times.append(1e3 * (perf_counter() - begun))
    typical, worst = median(times), quantiles(times, n=100)[98]
    said = f"median {typical:.2f} ms, 99th percentile {worst:.1f} ms"
    if not (math.isfinite(typical) and typical <= SLOWEST_MS):
        raise BrokenError(f"{said}: expected a median of at most {SLOWEST_MS:g} ms")
    return said


@dataclass(slots=True)
class _Track:
    """Record of the ego's state after every step."""

    rows: list[tuple[float, ...]] = field(default_factory=list)

    @property
    def travelled(self) -> float:
        return self.rows[-1][0] - self.rows[0][0]

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None: ...

    def stepped(self, snapshot: Snapshot) -> None:
        ego = snapshot.egos[0]
        self.rows.append((ego.x, ego.y, ego.heading, ego.speed, ego.acceleration, ego.steering))


def _drive(factory: Factory) -> _Track:
    world = ToyWorld(
        road=ToyRoad(lanes=2, crossings=(ToyCrossing(60.0),)),
        pedestrians=(ToyPedestrian("somebody", walk(62.0, -4.0, 0.0, 1.2, start=1.5)),),
        vehicles=(ToyVehicle("leader", walk(45.0, 0.0, 9.0, 0.0)),),
        speed=10.0,
        duration=8.0,
    )
    record = _Track()
    with made(factory) as controller:
        run(world, {"ego": controller}, record)
    return record
