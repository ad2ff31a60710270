"""The same control step as a user would otherwise write it, to compare with.

States are variables with equality dynamics, every pedestrian has a row per step, the matrices are put
together in Python loops and ``qpsolvers.solve_qp`` is called afresh for every program of every step. What
is decided around the programs (who is in conflict, which passing classes are solved) is shared code, so
both solve the same programs; run as a script, this file shows that their optima agree.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import qpsolvers
from measuring.loop_built import LoopBuilt
from numpy.typing import NDArray

from controllers.conflicts.path_conflicts import Conflicts
from controllers.interface import Body, Perception
from controllers.optimisation.solve import Memory
from controllers.velocity_obstacle.mpc.arithmetic import speed_program
from controllers.velocity_obstacle.mpc.horizon import lagged_ramp
from controllers.velocity_obstacle.mpc.lateral import LateralProgram, SteeringPlan, SteeringTask
from controllers.velocity_obstacle.mpc.longitudinal import LongitudinalProgram, SpeedPlan, SpeedTask
from controllers.velocity_obstacle.mpc.speed_planning import SpeedPlanner

FloatArray = NDArray[np.float64]

P, V, A, C = range(4)
"""States of a step: position, speed, acceleration and its command."""
Y, HEADING, ANGLE, ANGLE_COMMAND = range(4)
"""States of a step: offset, heading error, steering angle and its command."""
UPPER, LOWER, HEADWAY, EMERGENCY = range(4)
"""Slacks of the speed program."""


def solve(arrays: dict[str, Any], tolerance: float) -> FloatArray | None:
    """Solve with OSQP through qpsolvers, set up from nothing."""
    answer = qpsolvers.solve_qp(**arrays, solver="osqp", eps_abs=tolerance, eps_rel=tolerance, max_iter=4000)
    return None if answer is None else np.asarray(answer)


@dataclass(frozen=True, slots=True)
class PassingTask:
    """A speed task that remembers who its position bounds come from."""

    merged: SpeedTask
    base: SpeedTask
    """Without pedestrians."""
    conflicts: Conflicts
    behind: int
    body: Body
    margin_along: float

    def __getattr__(self, name: str) -> Any:
        return getattr(self.merged, name)

    def _replace(self, **values: Any) -> PassingTask:
        return replace(self, merged=self.merged._replace(**values))


class NaiveSpeedPlanner(SpeedPlanner):
    """Chooses passing classes as the original does, but hands on every pedestrian's own rows."""

    __slots__ = ()

    def _bounded(
        self, perception: Perception, task: SpeedTask, conflicts: Conflicts, behind: int
    ) -> PassingTask:
        return PassingTask(
            merged=super()._bounded(perception, task, conflicts, behind),
            base=task,
            conflicts=conflicts,
            behind=behind,
            body=perception.ego.body,
            margin_along=self.settings.margin_along,
        )


class NaiveSpeedProgram:
    """Stands in for :class:`controllers.velocity_obstacle.mpc.longitudinal.LongitudinalProgram`."""

    def __init__(self, like: LongitudinalProgram, lag: float) -> None:
        self.dt = like.dt
        self.lag = lag
        self.weights = like.weights
        self.limits = like.limits
        self.tolerance = like.solver.tolerance

    def worth_another_pass(self, task: PassingTask, plan: SpeedPlan) -> bool:
        """Decide as the original does."""
        return speed_program.departs(task.expected, plan.speed, task.stoppable)

    def solve(self, task: PassingTask, **_: Any) -> SpeedPlan:
        """Return the plan for a task; nothing outlives a call, so whatever else is given is not used."""
        n = len(self.dt)
        z = solve(self.build(task), self.tolerance)
        if z is None:
            none = np.zeros(n)
            return SpeedPlan(False, none, none, none, none, np.inf, 0.0, 0.0, none)
        return self.plan(task, z)

    def plan(self, task: SpeedTask, z: FloatArray) -> SpeedPlan:
        """Return the plan that a solution stands for."""
        n = len(self.dt)
        table, slack = z[: 5 * n].reshape(n, 5), z[5 * n :]
        return SpeedPlan(
            True,
            table[:, P],
            np.maximum(table[:, V], 0.0),
            table[:, A],
            table[:, C],
            self.cost(task, z),
            float(max(slack[UPPER], slack[LOWER], 0.0)),
            float(max(slack[EMERGENCY], 0.0)),
            z,
        )

    def cost(self, task: SpeedTask, z: FloatArray) -> float:
        """Return the objective, constants included."""
        n, w = len(self.dt), self.weights
        total = 0.0
        for k in range(n):
            _, speed, acceleration, _, jerk = z[5 * k : 5 * k + 5]
            total += self.dt[k] * (
                w.speed * (speed - task.reference[k]) ** 2
                + w.acceleration * acceleration**2
                + w.jerk * jerk**2
            )
        slack = z[5 * n :]
        total += w.violation * (slack[UPPER] + slack[LOWER])
        total += w.violation_squared * (slack[UPPER] ** 2 + slack[LOWER] ** 2)
        total += w.headway * slack[HEADWAY] + w.headway_squared * slack[HEADWAY] ** 2
        total += w.emergency * slack[EMERGENCY] + w.emergency_squared * slack[EMERGENCY] ** 2
        return float(total)

    def build(self, task: PassingTask) -> dict[str, Any]:
        """Put the program together, row by row."""
        n, dt, w, limits, base = len(self.dt), self.dt, self.weights, self.limits, task.base
        qp = LoopBuilt(n, 4)
        start = np.array([0.0, task.speed, task.acceleration, task.command])
        ramp = lagged_ramp(dt, self.lag)
        fastest = max(float(task.reference.max()), task.speed + 0.5 * max(task.acceleration, 0.0)) + 0.3
        # Half way to the strongest braking and to full acceleration: what speed is within reach at least.
        slowing = self._half_way(-limits.comfortable_braking, task.command)
        speeding = self._half_way(limits.acceleration, task.command)
        slowed, sped_up = start, start
        for k in range(n):
            matrix = np.array(
                [
                    [1.0, dt[k], self.lag * ramp.ramp[k], ramp.double[k]],
                    [0.0, 1.0, ramp.first[k], ramp.ramp[k]],
                    [0.0, 0.0, ramp.decay[k], 1.0 - ramp.decay[k]],
                    [0.0, 0.0, 0.0, 1.0],
                ]
            )
            inputs = np.array([ramp.triple[k], ramp.double[k], ramp.ramp[k], dt[k]])
            qp.dynamics(k, matrix, inputs, np.zeros(4), start)
            slowed = matrix @ slowed + slowing[k] * inputs
            sped_up = matrix @ sped_up + speeding[k] * inputs
            p, v, a, c, u = (5 * k + i for i in range(5))
            qp.square(v, dt[k] * w.speed, task.reference[k])
            qp.square(a, dt[k] * w.acceleration)
            qp.square(u, dt[k] * w.jerk)
            qp.lower[u], qp.upper[u] = -limits.jerk, limits.jerk
            highest = fastest if task.ceiling is None else min(fastest, float(task.ceiling[k]))
            qp.upper[v] = max(highest, slowed[V] + 0.05)
            qp.lower[v] = min(0.0, sped_up[V] - 0.05)
            qp.upper[c] = max(limits.acceleration, task.command)
            qp.at_most([(c, -1.0), (qp.slack(EMERGENCY), -1.0)], limits.comfortable_braking)
            qp.at_most([(p, 1.0), (qp.slack(UPPER), -1.0)], base.upper[k])
            qp.at_most([(p, -1.0), (qp.slack(LOWER), -1.0)], -base.lower[k])
            qp.at_most([(p, 1.0), (v, limits.headway), (qp.slack(HEADWAY), -1.0)], base.headway[k])
            self._stoppable(qp, k, base.stoppable[k], task.expected[k])
        self._pedestrians(qp, task)
        for i, (linear, squared) in enumerate(
            (
                (w.violation, w.violation_squared),
                (w.violation, w.violation_squared),
                (w.headway, w.headway_squared),
                (w.emergency, w.emergency_squared),
            )
        ):
            qp.square(qp.slack(i), squared)
            qp.q[qp.slack(i)] += linear
            qp.lower[qp.slack(i)] = 0.0
        qp.upper[qp.slack(EMERGENCY)] = limits.emergency_braking - limits.comfortable_braking
        return qp.arrays()

    def _half_way(self, command: float, present: float) -> list[float]:
        """Return jerks that lead half way to a command, at half the jerk allowed."""
        jerks, time, before = [], 0.0, 0.0
        for dt in self.dt:
            time += dt
            reach = 0.5 * self.limits.jerk * time
            change = min(max(0.5 * command - present, -reach), reach)
            jerks.append((change - before) / dt)
            before = change
        return jerks

    def _stoppable(self, qp: LoopBuilt, k: int, place: float, expected: float) -> None:
        slope = max(expected, 0.0) / self.limits.freeze_braking
        terms = [(qp.state(k, P), 1.0), (qp.state(k, V), slope), (qp.slack(UPPER), -1.0)]
        qp.at_most(terms, place + 0.5 * slope * expected)

    def _pedestrians(self, qp: LoopBuilt, task: PassingTask) -> None:
        """Add one half-plane per pedestrian and step, and one for those who might stop walking."""
        people, body, expected = task.conflicts, task.body, task.base.expected
        times = np.cumsum(self.dt)
        for i in range(len(people)):
            reach = people.radius[i] + task.margin_along
            for k in range(len(times)):
                before = times[k - 1] if k else 0.0
                after = times[k + 1] if k + 1 < len(times) else np.inf
                if before >= people.leave[i]:
                    continue
                x = people.along[i] + people.along_speed[i] * min(times[k], 3.0)
                if i < task.behind:
                    limit = x - reach
                    if body.front <= people.stop_line[i] + 0.3:
                        limit = min(limit, max(people.stop_line[i], body.front))
                    late = expected[k] * max(times[k] - people.leave[i], 0.0)
                    terms = [(qp.state(k, P), 1.0), (qp.slack(UPPER), -1.0)]
                    qp.at_most(terms, limit - body.front + late)
                    if after > people.enter[i]:
                        self._stoppable(qp, k, limit - 0.25 - body.front, task.expected[k])
                elif times[k] >= people.enter[i]:
                    late = expected[k] * (times[k] - people.enter[i]) if before < people.enter[i] else 0.0
                    terms = [(qp.state(k, P), -1.0), (qp.slack(LOWER), -1.0)]
                    # Nothing pulls the ego beyond people who are let pass and vehicles.
                    place = min(x + reach + body.rear_overhang + late, float(task.merged.upper[k]))
                    qp.at_most(terms, -place)


class NaiveSteeringProgram:
    """Stands in for :class:`controllers.velocity_obstacle.mpc.lateral.LateralProgram`."""

    def __init__(self, like: LateralProgram, lag: float, max_rate: float) -> None:
        self.dt = like.dt
        self.lag = lag
        self.max_rate = max_rate
        self.wheelbase = like.wheelbase
        self.front = like.front
        self.max_steering = like.max_steering
        self.weights = like.weights
        self.tolerance = like.solver.tolerance

    def solve(self, task: SteeringTask, **_: Any) -> SteeringPlan:
        """Return the plan for a task; nothing outlives a call, so whatever else is given is not used."""
        n = len(self.dt)
        z = solve(self.build(task), self.tolerance)
        if z is None:
            none = np.zeros(n)
            return SteeringPlan(False, none, none, none, np.inf, 0.0, none)
        table = z[: 5 * n].reshape(n, 5)
        cost, outside = self.cost(task, z), float(max(z[-1], 0.0))
        return SteeringPlan(True, table[:, Y], table[:, HEADING], table[:, ANGLE_COMMAND], cost, outside, z)

    def cost(self, task: SteeringTask, z: FloatArray) -> float:
        """Return the objective, constants included."""
        w = self.weights
        total = w.leaving * (z[-1] ** 2 + z[-1])
        for k in range(len(self.dt)):
            y, heading, angle, _, rate = z[5 * k : 5 * k + 5]
            total += self.dt[k] * (
                w.across * (y - task.target[k]) ** 2
                + w.heading * heading**2
                + self._angle_weight(task.speed[k]) * (angle - self.wheelbase * task.curvature[k]) ** 2
                + w.rate * rate**2
            )
        return float(total)

    def build(self, task: SteeringTask) -> dict[str, Any]:
        """Put the program together, row by row."""
        dt, w = self.dt, self.weights
        qp = LoopBuilt(len(dt), 1)
        start = np.array([task.across, task.heading_error, task.steering, task.command])
        r = lagged_ramp(dt, self.lag)
        outside = (qp.slack(0), -1.0)
        for k in range(len(dt)):
            speed = task.speed[k]
            bend = speed / self.wheelbase
            matrix = np.array(
                [
                    [1.0, speed * dt[k], speed * bend * self.lag * r.ramp[k], speed * bend * r.double[k]],
                    [0.0, 1.0, bend * r.first[k], bend * r.ramp[k]],
                    [0.0, 0.0, r.decay[k], 1.0 - r.decay[k]],
                    [0.0, 0.0, 0.0, 1.0],
                ]
            )
            inputs = np.array([speed * bend * r.triple[k], bend * r.double[k], r.ramp[k], dt[k]])
            turn = task.curvature[k] * speed * dt[k]
            qp.dynamics(k, matrix, inputs, np.array([-0.5 * turn * speed * dt[k], -turn, 0.0, 0.0]), start)
            y, heading, angle, command, rate = (5 * k + i for i in range(5))
            qp.square(y, dt[k] * w.across, task.target[k])
            qp.square(heading, dt[k] * w.heading)
            qp.square(angle, dt[k] * self._angle_weight(speed), self.wheelbase * task.curvature[k])
            qp.square(rate, dt[k] * w.rate)
            qp.lower[rate], qp.upper[rate] = -self.max_rate, self.max_rate
            qp.lower[command], qp.upper[command] = -self.max_steering, self.max_steering
            qp.at_most([(y, 1.0), outside], task.left[k])
            qp.at_most([(y, -1.0), outside], -task.right[k])
            qp.at_most([(y, 1.0), (heading, self.front), outside], task.left[k])
            qp.at_most([(y, -1.0), (heading, -self.front), outside], -task.right[k])
        qp.square(qp.slack(0), w.leaving)
        qp.q[qp.slack(0)] += w.leaving
        qp.lower[qp.slack(0)] = 0.0
        return qp.arrays()

    def _angle_weight(self, speed: float) -> float:
        w = self.weights
        return float(w.steering + w.lateral_acceleration * (speed**2 / self.wheelbase) ** 2)


def twin(original: Any, perception: Perception) -> Any:
    """Return a copy of a controller as it stands, its two programs replaced by the naive ones.

    Parameters
    ----------
    original
        A ``vo_mpc`` controller that has planned at least once.
    perception
        Any, for the ego's actuators.
    """
    drive = perception.ego.drive
    speed = NaiveSpeedProgram(original._speed.program, drive.drive_lag)
    steering = NaiveSteeringProgram(original._steering, drive.steering_lag, drive.max_steering_rate)
    kept = {
        id(original._speed.program): speed,
        id(original._steering): steering,
        id(original.settings): original.settings,
        # What our own solves remember, OSQP's workspace for one, is of no use to the naive ones.
        id(original._speed.solves): Memory(),
        id(original._steering_memory): Memory(),
    }
    naive = copy.deepcopy(original, kept)
    planner = NaiveSpeedPlanner.__new__(NaiveSpeedPlanner)
    for field in fields(naive._speed):
        setattr(planner, field.name, getattr(naive._speed, field.name))
    naive._speed = planner
    return naive


if __name__ == "__main__":
    from measuring.agreement import check
    from measuring.perceptions import CASES

    check(CASES)
