"""The speed plan: a quadratic program over the changes of the commanded acceleration.

``minimise sum dt [w_v (v - v_ref)^2 + w_a a^2 + w_j j^2] + slacks`` subject to bounds on the position
(pedestrians, stop lines, vehicles), on speed, command and jerk. Whatever bounds the position alone is
merged before it gets here, so the layout does not depend on who is around.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.mpc.horizon import ACCELERATION, COMMAND, POSITION, SPEED, LongitudinalHorizon
from controllers.programs.qp import Program

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


@dataclass(frozen=True, slots=True)
class SpeedTask:
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


@dataclass(frozen=True, slots=True)
class SpeedPlan:
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
    """

    # Blocks of N rows each.
    UPPER, LOWER, STOPPABLE, HEADWAY, FAST, SLOW, BRAKE, JERK_UP, JERK_DOWN = range(9)
    BLOCKS = 9
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
    ) -> None:
        self.steps = n = len(dt)
        self.dt = dt
        self.weights = weights
        self.limits = limits
        self.horizon = LongitudinalHorizon(dt, lag)
        self._half_jerk = 0.5 * limits.jerk * np.cumsum(dt)
        self._scale: dict[int, FloatArray] = {}
        self.program = Program(self._cost_pattern(n), self._row_pattern(n), solver, tolerance)
        self._fill_constant_parts()

    def build(self, task: SpeedTask) -> FloatArray:
        """Write the task into the program and return the free response, shape (4, N)."""
        n, p, limits, h = self.steps, self.program, self.limits, self._bounds
        v = self.horizon.gain[SPEED]
        free = self.horizon.free(task.speed, task.acceleration, task.command)
        position, speed = free[POSITION], free[SPEED]
        p.q[:n] = self._speed_cost @ (speed - task.reference) + self._acceleration_cost @ free[ACCELERATION]
        h[self.UPPER] = task.upper - position
        h[self.LOWER] = position - task.lower
        slope = np.maximum(task.expected, 0.0) / limits.freeze_braking
        np.add(
            self._stoppable[0],
            slope[:, None] * self._stoppable[1],
            out=p.G[self._rows(self.STOPPABLE), :n],
        )
        h[self.STOPPABLE] = task.stoppable + 0.5 * slope * task.expected - position - slope * speed
        h[self.HEADWAY] = task.headway - position - limits.headway * speed
        # Bounds that the state may already violate are moved to what is still reachable: the program
        # must have a solution from any state.
        present = task.speed + 0.5 * max(task.acceleration, 0.0)
        fastest = np.full(n, max(float(task.reference.max()), present) + 0.3)
        if task.ceiling is not None:
            fastest = np.minimum(fastest, task.ceiling)
        slowed = v @ self._towards(-limits.comfortable_braking, task.command)
        h[self.FAST] = np.maximum(fastest - speed, slowed + 0.05)
        recovered = v @ self._towards(limits.acceleration, task.command)
        h[self.SLOW] = np.maximum(speed, 0.05 - recovered)
        h[self.BRAKE] = limits.comfortable_braking + free[COMMAND]
        np.multiply(h, self._row_scale, out=p.h[: h.size].reshape(h.shape))
        p.upper[:n] = max(limits.acceleration - task.command, 0.0)
        return free

    def solve(self, task: SpeedTask, warm: FloatArray | None = None, kind: Hashable = None) -> SpeedPlan:
        """Return the plan for a task; ``found`` is False when the solver gave none.

        ``warm`` and ``kind`` as for :meth:`controllers.programs.qp.Program.solve`.
        """
        free = self.build(task)
        solution = self.program.solve(warm, kind)
        n = self.steps
        states = free + self.horizon.gain @ solution.z[:n]
        slack = SLACK_UNIT * solution.z[n:]
        return SpeedPlan(
            found=solution.found,
            position=states[POSITION],
            speed=np.maximum(states[SPEED], 0.0),
            acceleration=states[ACCELERATION],
            command=states[COMMAND],
            cost=solution.cost + self.constant_cost(free, task),
            slack=float(max(slack[self.SLACK_UPPER], slack[self.SLACK_LOWER], 0.0)),
            emergency=float(max(slack[self.EMERGENCY], 0.0)),
            inputs=solution.z,
        )

    def constant_cost(self, free: FloatArray, task: SpeedTask) -> float:
        """Return the part of the objective that no input changes, which the program leaves out."""
        w = self.weights
        return float(
            self.dt
            @ (w.speed * (free[SPEED] - task.reference) ** 2 + w.acceleration * free[ACCELERATION] ** 2)
        )

    def _towards(self, command: float, present: float) -> FloatArray:
        """Return the inputs that lead half way to a command at half the jerk: there is room left to drive."""
        step = 0.5 * command - present
        return np.minimum(self._half_jerk, step) if step > 0.0 else np.maximum(-self._half_jerk, step)

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)

    def _cost_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((n + self.SLACKS, n + self.SLACKS), dtype=bool)
        pattern[:n, :n] = True
        np.fill_diagonal(pattern, True)
        return pattern

    def _row_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((self.BLOCKS * n, n + self.SLACKS), dtype=bool)
        lower_triangle = np.tril(np.ones((n, n), dtype=bool))
        diagonal = np.eye(n, dtype=bool)
        neighbours = diagonal | np.eye(n, k=-1, dtype=bool)
        for block in range(self.BLOCKS):
            sparse = {self.BRAKE: diagonal, self.JERK_UP: neighbours, self.JERK_DOWN: neighbours}
            pattern[self._rows(block), :n] = sparse.get(block, lower_triangle)
        for block, slack in self._softened():
            pattern[self._rows(block), n + slack] = True
        return pattern

    def _softened(self) -> tuple[tuple[int, int], ...]:
        return (
            (self.UPPER, self.SLACK_UPPER),
            (self.STOPPABLE, self.SLACK_UPPER),
            (self.LOWER, self.SLACK_LOWER),
            (self.HEADWAY, self.SLACK_HEADWAY),
            (self.BRAKE, self.EMERGENCY),
        )

    def _fill_constant_parts(self) -> None:
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
            self.UPPER: s,
            self.LOWER: -s,
            self.HEADWAY: s + limits.headway * v,
            self.FAST: v,
            self.SLOW: -v,
            self.BRAKE: -c,
            self.JERK_UP: jerk,
            self.JERK_DOWN: -jerk,
        }
        # Rows of equal length: a metre at the end of the horizon then weighs no more than one at its
        # beginning in the solver's stopping criterion.
        self._scale = {
            block: 1.0 / np.sqrt((rows**2).sum(axis=1) + SLACK_UNIT**2)
            for block, rows in {**signed, self.STOPPABLE: s}.items()
        }
        for block, rows in signed.items():
            p.G[self._rows(block), :n] = self._scale[block][:, None] * rows
        for block, slack in self._softened():
            p.G[self._rows(block), n + slack] = -SLACK_UNIT * self._scale[block]
        for block in (self.JERK_UP, self.JERK_DOWN):
            p.h[self._rows(block)] = self._scale[block] * limits.jerk
        self._row_scale = np.array([self._scale[block] for block in range(self.JERK_UP)])
        self._bounds = np.empty_like(self._row_scale)
        scale = self._scale[self.STOPPABLE][:, None]
        self._stoppable = (scale * s, scale * v)
        self._speed_cost = 2.0 * w.speed * v.T * self.dt
        self._acceleration_cost = 2.0 * w.acceleration * a.T * self.dt
        p.lower[n:] = 0.0
        p.upper[n + self.EMERGENCY] = (limits.emergency_braking - limits.comfortable_braking) / SLACK_UNIT
