"""The speed plan: a quadratic program over the changes of the commanded acceleration.

``minimise sum dt [w_v (v - v_ref)^2 + w_a a^2 + w_j j^2] + slacks`` subject to bounds on the position
(pedestrians, stop lines, vehicles), on speed, command and jerk. Whatever bounds the position alone is
merged before it gets here, so the layout does not depend on who is around.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.mpc.horizon import LongitudinalHorizon
from controllers.numerics import speed_program
from controllers.numerics.compiling import code_of
from controllers.numerics.speed_program import (
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
from controllers.programs.qp import Memory, Program

FloatArray = NDArray[np.float64]


SLACK_UNIT = 0.1
"""Slack variables are in tenths of a metre (of a m/s^2): as large as the other variables, for the solver."""


@dataclass(frozen=True, slots=True)
class SpeedWeights:
    """Weights of the objective; each is per second of horizon."""

    speed: float = 0.3
    """[1/(m/s)^2]"""
    acceleration: float = 1.0
    """[1/(m/s^2)^2]"""
    jerk: float = 0.6
    """[1/(m/s^3)^2]"""
    violation: float = 100.0
    """Per metre that a position bound is violated."""
    violation_squared: float = 100.0
    headway: float = 8.0
    """Per metre that the time gap to the vehicle ahead is short."""
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
    """Wanted speed [m/s]."""
    expected: FloatArray
    """Speed about which the braking distance is linearised [m/s]."""
    upper: FloatArray
    lower: FloatArray
    stoppable: FloatArray
    """The ego must be able to stop before this position; inf where it need not."""
    headway: FloatArray
    """Position plus time gap times speed must stay below this; inf without a vehicle ahead."""
    ceiling: FloatArray | None = None
    """Speed not to be exceeded, however late the ego is; ``None`` for the wanted speed's maximum [m/s]."""


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


class LongitudinalProgram:
    """Builds and solves speed plans of one layout.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of drive and brake [s].
    weights, limits
        See there.
    solver, tolerance, compiled
        As for :class:`controllers.programs.qp.Program`; compiled, the tasks are written by compiled code too.
    """

    # Slack variables behind the N inputs.
    SLACK_UPPER, SLACK_LOWER, SLACK_HEADWAY, EMERGENCY = range(4)
    SLACKS = 4

    def __init__(
        self,
        dt: FloatArray,
        lag: float,
        weights: SpeedWeights,
        limits: SpeedLimits,
        solver: str = "osqp",
        tolerance: float = 1e-4,
        compiled: bool = False,
    ) -> None:
        self.steps = n = len(dt)
        self.dt = dt
        self.weights = weights
        self.limits = limits
        self.horizon = LongitudinalHorizon(dt, lag)
        self._scale: dict[int, FloatArray] = {}
        self.program = Program(
            self._cost_pattern(n),
            self._row_pattern(n),
            solver,
            tolerance,
            compiled=compiled,
            constant_cost=True,
        )
        self._layout, self._written = self._fill_constant_parts()
        self._gain = self.horizon.gain.reshape(4 * n, n)
        self._tracking = np.array([weights.speed, weights.acceleration])
        self._no_ceiling = np.full(n, np.inf)
        self.compiled = compiled
        self._code = code_of(speed_program, compiled)

    def build(self, task: SpeedTask) -> FloatArray:
        """Write the task into the program and return the free response, shape (4, N)."""
        free: FloatArray = self._code.write(
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
        return free

    def solve(
        self,
        task: SpeedTask,
        warm: FloatArray | None = None,
        kind: Hashable = None,
        memory: Memory | None = None,
    ) -> SpeedPlan:
        """Return the plan for a task; ``found`` is False when the solver gave none.

        ``warm``, ``kind`` and ``memory`` as for :meth:`controllers.programs.qp.Program.solve`.
        """
        free = self.build(task)
        solution = self.program.solve(warm, kind, memory)
        return self.plan(task, free, solution.z, solution.cost, solution.found)

    def worth_another_pass(self, task: SpeedTask, plan: SpeedPlan) -> bool:
        """Return whether a plan is far from the speeds about which its braking distance was linearised."""
        return bool(self._code.departs(task.expected, plan.speed, task.stoppable))

    def plan(self, task: SpeedTask, free: FloatArray, z: FloatArray, cost: float, found: bool) -> SpeedPlan:
        """Return what inputs and slacks mean.

        Parameters
        ----------
        task : as built
        free : states without input, shape (4, N)
        z : inputs and slacks
        cost : objective of the program at ``z``
        found : whether that is a solution
        """
        states, constant = self._code.states(free, self._gain, z, task.reference, self.dt, self._tracking)
        slack = z[self.steps :]
        return SpeedPlan(
            found=found,
            position=states[POSITION],
            speed=states[SPEED],
            acceleration=states[ACCELERATION],
            command=states[COMMAND],
            cost=cost + constant,
            slack=SLACK_UNIT * float(max(slack[self.SLACK_UPPER], slack[self.SLACK_LOWER], 0.0)),
            emergency=SLACK_UNIT * float(max(slack[self.EMERGENCY], 0.0)),
            inputs=z,
        )

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)

    def _cost_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((n + self.SLACKS, n + self.SLACKS), dtype=bool)
        pattern[:n, :n] = True
        np.fill_diagonal(pattern, True)
        return pattern

    def _row_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((BLOCKS * n, n + self.SLACKS), dtype=bool)
        lower_triangle = np.tril(np.ones((n, n), dtype=bool))
        diagonal = np.eye(n, dtype=bool)
        neighbours = diagonal | np.eye(n, k=-1, dtype=bool)
        for block in range(BLOCKS):
            sparse = {BRAKE: diagonal, JERK_UP: neighbours, JERK_DOWN: neighbours}
            pattern[self._rows(block), :n] = sparse.get(block, lower_triangle)
        for block, slack in self._softened():
            pattern[self._rows(block), n + slack] = True
        return pattern

    def _softened(self) -> tuple[tuple[int, int], ...]:
        return (
            (UPPER, self.SLACK_UPPER),
            (STOPPABLE, self.SLACK_UPPER),
            (LOWER, self.SLACK_LOWER),
            (HEADWAY, self.SLACK_HEADWAY),
            (BRAKE, self.EMERGENCY),
        )

    def _fill_constant_parts(self) -> tuple[speed_program.Layout, speed_program.Program]:
        """Write what does not change; return what the rest is worked out from, and where it goes."""
        n, p, w, limits = self.steps, self.program, self.weights, self.limits
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
        # Rows of equal length: a metre at the end of the horizon then weighs no more than one at its
        # beginning in the solver's stopping criterion.
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
            freeze_braking=limits.freeze_braking,
            headway=limits.headway,
        )
        written = speed_program.Program(
            p.q[:n], p.G[self._rows(STOPPABLE), :n], p.h[: len(changing) * n].reshape(-1, n), p.upper[:n]
        )
        return layout, written
