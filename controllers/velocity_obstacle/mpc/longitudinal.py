"""The speed plan: a quadratic program over the changes of the commanded acceleration.

``minimise sum dt [w_v (v - v_ref)^2 + w_a a^2 + w_j j^2] + slacks`` subject to bounds on the position
(pedestrians, stop lines, vehicles), on speed, command and jerk. Everything that bounds the position alone is
merged before it gets here, so the layout does not depend on which road users are around.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory, solve
from controllers.velocity_obstacle.mpc.arithmetic import speed_program
from controllers.velocity_obstacle.mpc.arithmetic.speed_program import (
    ACCELERATION,
    BLOCKS,
    BRAKE,
    COMMAND,
    FAST,
    HEADWAY,
    JERK_DOWN,
    JERK_UP,
    LOWER,
    POSITION,
    SLOW,
    SPEED,
    STOPPABLE,
    UPPER,
)
from controllers.velocity_obstacle.mpc.horizon import LongitudinalHorizon

SLACK_UNIT = 0.1
"""Unit of the slack variables, which the solver needs to be about as large as the others [m or m/s^2]."""
ROWS = {
    UPPER: "position below what is ahead, softened",
    LOWER: "position beyond whom the ego goes ahead of, softened",
    STOPPABLE: "stopping place before what is ahead, softened",
    HEADWAY: "time gap to the vehicle ahead, softened",
    FAST: "speed below the ceiling",
    SLOW: "speed not negative",
    BRAKE: "braking comfortable, softened",
    JERK_UP: "jerk below its limit",
    JERK_DOWN: "jerk above its limit",
}
"""Meaning of the blocks of rows; each row is divided by the length of its gradient."""


@dataclass(frozen=True, slots=True)
class SpeedWeights:
    """Weights of the objective; each is per second of horizon."""

    speed: float = 0.3
    """[1/(m/s)^2]"""
    acceleration: float = 0.25
    """[1/(m/s^2)^2]"""
    jerk: float = 0.3
    """[1/(m/s^3)^2]"""
    violation: float = 100.0
    """Per metre that a position bound is violated."""
    violation_squared: float = 100.0
    headway: float = 8.0
    """Per metre by which the time gap to the vehicle ahead is too short."""
    headway_squared: float = 1.0
    emergency: float = 20.0
    """Per m/s^2 of braking beyond the comfortable limit."""
    emergency_squared: float = 10.0


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Limits of the commanded acceleration and its jerk, and the braking that must remain possible."""

    acceleration: float = 1.8
    comfortable_braking: float = 3.0
    emergency_braking: float = 8.0
    jerk: float = 12.0
    freeze_braking: float = 7.0
    """Braking with which the ego could still stop should a pedestrian stop in its path [m/s^2]."""
    headway: float = 1.0
    """[s]"""


class SpeedTask(NamedTuple):
    """One speed plan to make: bounds on the rear axle's position from now, each of shape (N,)."""

    speed: float
    acceleration: float
    command: float
    """Acceleration commanded last [m/s^2]."""
    reference: FloatArray
    """Speed to track: the wanted speed, or less on the approach to where the ego stops [m/s]."""
    wanted: FloatArray
    """Speed without anybody to stop for; plans are priced against it, so that stopping has a cost [m/s]."""
    positions: FloatArray
    """Positions of the rear axle expected from the previous plan [m]."""
    expected: FloatArray
    """Speed about which the braking distance is linearised [m/s]."""
    upper: FloatArray
    lower: FloatArray
    stoppable: FloatArray
    """The ego must be able to stop before this position; inf where it need not."""
    headway: FloatArray
    """Position plus time gap times speed must stay below this; inf without a vehicle ahead."""
    ceiling: FloatArray | None = None
    """Speed that must never be exceeded, however late the ego is; ``None``: the largest to track [m/s]."""


class SpeedPlan(NamedTuple):
    """States at the end of each interval, shape (N,) each."""

    found: bool
    position: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    command: FloatArray
    cost: float
    slack: float
    """Largest violation of a position bound [m]."""
    emergency: float
    """Braking beyond the comfortable limit [m/s^2]."""
    inputs: FloatArray
    priced: float = 0.0
    """Part of the cost that the program does not minimise, for driving slower than the wanted speed."""


class LongitudinalProgram:
    """Builds and solves speed programs that share one layout.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of drive and brake [s].
    weights, limits
        See :class:`SpeedWeights` and :class:`SpeedLimits`.
    solver
        Settings of the solver.
    """

    # Slack variables, which follow the N inputs.
    SLACK_UPPER, SLACK_LOWER, SLACK_HEADWAY, EMERGENCY = range(4)
    SLACKS = 4

    def __init__(
        self,
        dt: FloatArray,
        lag: float,
        weights: SpeedWeights,
        limits: SpeedLimits,
        solver: SolverSettings | None = None,
    ) -> None:
        self.steps = n = len(dt)
        self.dt = dt
        self.weights = w = weights
        self.limits = limits
        self.solver = solver or SolverSettings()
        self.horizon = LongitudinalHorizon(dt, lag)
        self._scale: dict[int, FloatArray] = {}
        self.problem: Problem = blank(
            f"sum dt [{w.speed:g} (v - v_ref)^2 + {w.acceleration:g} a^2 + {w.jerk:g} j^2] + softened rows",
            {
                "change of the commanded acceleration [m/s^2]": n,
                "too far forward [0.1 m]": 1,
                "too far back [0.1 m]": 1,
                "time gap too short [0.1 m]": 1,
                "braking beyond the comfortable limit [0.1 m/s^2]": 1,
            },
            {ROWS[block]: n for block in range(BLOCKS)},
        )
        self._layout, self._written = self._fill_constant_parts()
        self._gain = self.horizon.gain.reshape(4 * n, n)
        self._tracking = np.array([weights.speed, weights.acceleration])
        self._no_ceiling = np.full(n, np.inf)

    def build(self, task: SpeedTask) -> FloatArray:
        """Write the task into the problem and return the free response, shape (4, N)."""
        return speed_program.write(
            self._layout,
            self._written,
            task.speed,
            task.acceleration,
            task.command,
            task.reference,
            task.expected,
            task.upper,
            task.lower,
            task.stoppable,
            task.headway,
            self._no_ceiling if task.ceiling is None else task.ceiling,
        )

    def solve(
        self,
        task: SpeedTask,
        start: FloatArray | None = None,
        memory: Memory | None = None,
    ) -> SpeedPlan:
        """Return the plan for a task; ``found`` is False when it was not solved.

        ``start`` and ``memory`` as for :func:`controllers.optimisation.solve.solve`.
        """
        free = self.build(task)
        solution = solve(self.problem, self.solver, memory, start)
        return self.plan(task, free, solution.z, solution.cost, solution.solved)

    def worth_another_pass(self, task: SpeedTask, plan: SpeedPlan) -> bool:
        """Return whether a plan is far from the speeds about which its braking distance was linearised."""
        return speed_program.departs(task.expected, plan.speed, task.stoppable)

    def plan(self, task: SpeedTask, free: FloatArray, z: FloatArray, cost: float, found: bool) -> SpeedPlan:
        """Return the speed plan that inputs and slacks stand for.

        Parameters
        ----------
        task : the task that the problem was built for
        free : states without input, shape (4, N)
        z : inputs and slacks
        cost : objective of the problem at ``z``
        found : whether ``z`` is a solution
        """
        states, constant = speed_program.states(free, self._gain, z, task.reference, self.dt, self._tracking)
        speed = states[SPEED]
        late = self.dt @ ((speed - task.wanted) ** 2 - (speed - task.reference) ** 2)
        priced = self.weights.speed * float(late)
        slack = z[self.steps :]
        return SpeedPlan(
            found=found,
            position=states[POSITION],
            speed=speed,
            acceleration=states[ACCELERATION],
            command=states[COMMAND],
            cost=cost + constant + priced,
            slack=SLACK_UNIT * float(max(slack[self.SLACK_UPPER], slack[self.SLACK_LOWER], 0.0)),
            emergency=SLACK_UNIT * float(max(slack[self.EMERGENCY], 0.0)),
            inputs=z,
            priced=priced,
        )

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)

    def _softened(self) -> tuple[tuple[int, int], ...]:
        return (
            (UPPER, self.SLACK_UPPER),
            (STOPPABLE, self.SLACK_UPPER),
            (LOWER, self.SLACK_LOWER),
            (HEADWAY, self.SLACK_HEADWAY),
            (BRAKE, self.EMERGENCY),
        )

    def _fill_constant_parts(self) -> tuple[speed_program.Layout, speed_program.Program]:
        """Write the constant parts; return what the rest is computed from, and where it is written to."""
        n, p, w, limits = self.steps, self.problem, self.weights, self.limits
        s, v, a, c = self.horizon.gain
        jerk = self.horizon.jerk
        p.P[:n, :n] = 2.0 * (
            w.speed * (v.T * self.dt) @ v
            + w.acceleration * (a.T * self.dt) @ a
            + w.jerk * (jerk.T * self.dt) @ jerk
        )
        squares = (w.violation_squared, w.violation_squared, w.headway_squared, w.emergency_squared)
        p.P[range(n, n + self.SLACKS), range(n, n + self.SLACKS)] = 2.0 * SLACK_UNIT**2 * np.array(squares)
        p.q[n:] = SLACK_UNIT * np.array((w.violation, w.violation, w.headway, w.emergency))
        signed = {
            UPPER: s,
            LOWER: -s,
            HEADWAY: s + limits.headway * v,
            FAST: v,
            SLOW: -v,
            BRAKE: -c,
            JERK_UP: jerk,
            JERK_DOWN: -jerk,
        }
        # Rows are scaled to equal length, so that a metre at the end of the horizon weighs no more than one
        # at its beginning in the solver's stopping criterion.
        self._scale = {
            block: 1.0 / np.sqrt((rows**2).sum(axis=1) + SLACK_UNIT**2)
            for block, rows in {**signed, STOPPABLE: s}.items()
        }
        for block, rows in signed.items():
            p.G[self._rows(block), :n] = self._scale[block][:, None] * rows
        for block, slack in self._softened():
            p.G[self._rows(block), n + slack] = -SLACK_UNIT * self._scale[block]
        for block in (JERK_UP, JERK_DOWN):
            p.h[self._rows(block)] = self._scale[block] * limits.jerk
        p.lower[n:] = 0.0
        p.upper[n + self.EMERGENCY] = (limits.emergency_braking - limits.comfortable_braking) / SLACK_UNIT
        changing = range(JERK_UP)
        stoppable = self._scale[STOPPABLE][:, None]
        layout = speed_program.Layout(
            start=self.horizon.start.reshape(4 * n, 4),
            speed_gain=v,
            stoppable_position=stoppable * s,
            stoppable_speed=stoppable * v,
            speed_cost=2.0 * w.speed * np.ascontiguousarray(v.T) * self.dt,
            acceleration_cost=2.0 * w.acceleration * np.ascontiguousarray(a.T) * self.dt,
            row_scale=np.array([self._scale[block] for block in changing]),
            half_jerk=0.5 * limits.jerk * np.cumsum(self.dt),
            acceleration=limits.acceleration,
            comfortable_braking=limits.comfortable_braking,
            emergency_braking=limits.emergency_braking,
            freeze_braking=limits.freeze_braking,
            headway=limits.headway,
        )
        written = speed_program.Program(
            p.q[:n], p.G[self._rows(STOPPABLE), :n], p.h[: len(changing) * n].reshape(-1, n), p.upper[:n]
        )
        return layout, written
