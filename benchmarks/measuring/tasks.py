"""The programs of recorded control steps, one pair per step: speed, then steering."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from controllers.interface import Drive
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory
from controllers.velocity_obstacle.mpc.lateral import LateralProgram, SteeringPlan, SteeringTask
from controllers.velocity_obstacle.mpc.longitudinal import LongitudinalProgram, SpeedPlan, SpeedTask
from measuring import perceptions
from measuring.perceptions import Case
from measuring.solvers import DEFAULT
from measuring.stopwatch import replaced

FIRM_PASSES = 8
"""Enough for the linearised braking distance to settle."""
SETTLED = 1e-4
"""Change of a speed plan from pass to pass that counts as none [m/s]."""
WORTH_A_PASS = 0.3
"""The same for the controller [m/s]."""


@dataclass(frozen=True, slots=True)
class Step:
    """What a control step ended up planning for."""

    speed: SpeedTask
    """Before the first pass."""
    steering: SteeringTask
    curvature: Any
    approach: int


@dataclass(frozen=True, slots=True)
class Layout:
    """What all tasks of a case have in common."""

    speed: LongitudinalProgram
    steering: LateralProgram
    drive: Drive


def collect(case: Case) -> tuple[Layout, list[Step]]:
    """Return the tasks of the classes that were followed, for every step but the first of each approach."""
    steps: list[Step] = []
    layout: Layout | None = None
    for number, approach in enumerate(perceptions.record(case)):
        driver: Any = perceptions.controller(case, DEFAULT)
        for i, perception in enumerate(approach):
            asked: list[tuple[SpeedTask, SpeedPlan]] = []
            steered: list[tuple[LateralProgram, SteeringTask]] = []
            with ExitStack() as stack:
                stack.enter_context(_noting_speed(asked))
                stack.enter_context(_noting_steering(steered))
                plan = driver.plan(perception, driver.decide(perception))
            followed = [entry for entry in asked if entry[1].position is plan.along]
            if i == 0 or not followed or not steered:
                continue
            # Of several passes of one class the first has the task as it was set.
            last = next(k for k, entry in enumerate(asked) if entry is followed[0])
            while last > 0 and asked[last][0].upper is asked[last - 1][0].upper:
                last -= 1
            steps.append(Step(asked[last][0], steered[-1][1], steered[-1][1].curvature, number))
            layout = layout or Layout(driver._speed.program, steered[-1][0], perception.ego.drive)
    if layout is None:
        raise SystemExit(f"no control step of case {case} was recorded")
    return layout, steps


def _noting_speed(into: list[tuple[SpeedTask, SpeedPlan]]) -> Any:
    solve = LongitudinalProgram.solve

    def noted(self: Any, task: SpeedTask, *args: Any, **kwargs: Any) -> SpeedPlan:
        plan = solve(self, task, *args, **kwargs)
        into.append((task, plan))
        return plan

    return replaced(LongitudinalProgram, "solve", noted)


def _noting_steering(into: list[tuple[LateralProgram, SteeringTask]]) -> Any:
    solve = LateralProgram.solve

    def noted(self: Any, task: SteeringTask, *args: Any, **kwargs: Any) -> SteeringPlan:
        into.append((self, task))
        return solve(self, task, *args, **kwargs)

    return replaced(LateralProgram, "solve", noted)


@dataclass(slots=True)
class Planner:
    """Our two programs with one solver, as the controller keeps them."""

    speed: LongitudinalProgram
    steering: LateralProgram
    memories: tuple[Memory, Memory] = field(default_factory=lambda: (Memory(), Memory()))

    @classmethod
    def like(cls, layout: Layout, solver: str, tolerance: float | None = None) -> Planner:
        """Return fresh programs of the same layout."""
        speed, steering, drive = layout.speed, layout.steering, layout.drive
        how = SolverSettings(solver, speed.solver.tolerance if tolerance is None else tolerance)
        return cls(
            LongitudinalProgram(speed.dt, drive.drive_lag, speed.weights, speed.limits, how),
            LateralProgram(
                steering.dt,
                drive.steering_lag,
                steering.wheelbase,
                steering.front,
                drive.max_steering,
                drive.max_steering_rate,
                steering.weights,
                how,
            ),
        )

    def plan(self, step: Step, firm: bool = False) -> tuple[SpeedPlan, SteeringPlan]:
        """Solve speed, then steering; with ``firm`` until the braking distance is where it was linearised."""
        task = step.speed
        plan = self.speed.solve(task, memory=self.memories[0])
        bounded = np.isfinite(task.stoppable)
        enough = SETTLED if firm else WORTH_A_PASS
        for _ in range(FIRM_PASSES if firm else 1):
            if not plan.found or not (np.abs(plan.speed - task.expected)[bounded] > enough).any():
                break
            task = task._replace(expected=plan.speed)
            plan = self.speed.solve(task, start=plan.inputs, memory=self.memories[0])
        return plan, self.steering.solve(self.along(step, plan), memory=self.memories[1])

    @staticmethod
    def along(step: Step, plan: SpeedPlan) -> SteeringTask:
        """Return the steering task for a speed plan; the lane's curvature stays where it was recorded."""
        mean = 0.5 * (plan.speed + np.concatenate(([step.speed.speed], plan.speed[:-1])))
        return step.steering._replace(speed=np.maximum(mean, 0.5))


def in_turn(steps: Sequence[Step], most: int) -> Iterator[list[Step]]:
    """Return runs of consecutive steps of one approach, about ``most`` in all, evenly spread."""
    runs = 4
    length = max(2, most // runs)
    for start in np.linspace(0, max(len(steps) - length, 0), runs).astype(int):
        yield list(steps[start : start + length])
