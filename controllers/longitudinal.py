"""The speed plan: a quadratic program over the jerk of the commanded acceleration.

``minimise sum dt [w_v (v - v_ref)^2 + w_a a^2 + w_j j^2] + slacks`` subject to bounds on the position
(pedestrians, stop lines, vehicles), on speed, command and jerk. Whatever bounds the position alone is
merged before it gets here, so the layout does not depend on who is around.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.horizon import ACCELERATION, COMMAND, POSITION, SPEED, LongitudinalHorizon
from controllers.qp import Program

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SpeedWeights:
    """Weights of the objective; each is per second of horizon."""

    speed: float = 0.2
    """[1/(m/s)^2]"""
    acceleration: float = 1.0
    """[1/(m/s^2)^2]"""
    jerk: float = 0.6
    """[1/(m/s^3)^2]"""
    violation: float = 400.0
    """Per metre that a position bound is violated."""
    violation_squared: float = 2000.0
    headway: float = 8.0
    """Per metre that the time gap to the vehicle ahead is short."""
    emergency: float = 60.0
    """Per m/s^2 of braking beyond the comfortable limit."""
    emergency_squared: float = 20.0


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
    UPPER, LOWER, STOPPABLE, HEADWAY, FAST, SLOW, PUSH, BRAKE = range(8)
    BLOCKS = 8
    # Slack variables behind the N jerks.
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
        self.program = Program(self._cost_pattern(n), self._row_pattern(n), solver, tolerance)
        self._fill_constant_parts()

    def build(self, task: SpeedTask) -> FloatArray:
        """Write the task into the program and return the free response, shape (4, N)."""
        n, p, limits = self.steps, self.program, self.limits
        s, v = self.horizon.gain[POSITION], self.horizon.gain[SPEED]
        free = self.horizon.free(task.speed, task.acceleration, task.command)
        w = self.weights
        weighted_speed = w.speed * self.dt * (free[SPEED] - task.reference)
        p.q[:n] = 2.0 * (v.T @ weighted_speed) + 2.0 * w.acceleration * (
            self.horizon.gain[ACCELERATION].T @ (self.dt * free[ACCELERATION])
        )
        p.h[self._rows(self.UPPER)] = task.upper - free[POSITION]
        p.h[self._rows(self.LOWER)] = free[POSITION] - task.lower
        slope = np.maximum(task.expected, 0.0) / limits.freeze_braking
        p.G[self._rows(self.STOPPABLE), :n] = s + slope[:, None] * v
        p.h[self._rows(self.STOPPABLE)] = (
            task.stoppable + 0.5 * slope * task.expected - free[POSITION] - slope * free[SPEED]
        )
        p.h[self._rows(self.HEADWAY)] = task.headway - free[POSITION] - limits.headway * free[SPEED]
        # Bounds that the state may already violate are moved to what is still reachable: the program
        # must have a solution from any state.
        fastest = max(float(task.reference.max()), task.speed + 0.5 * max(task.acceleration, 0.0)) + 0.3
        slowed = free[SPEED] - v @ np.full(n, limits.jerk)
        p.h[self._rows(self.FAST)] = np.maximum(fastest, slowed + 0.05) - free[SPEED]
        recovered = free[SPEED] + v @ np.full(n, limits.jerk)
        p.h[self._rows(self.SLOW)] = free[SPEED] - np.minimum(0.0, recovered - 0.05)
        p.h[self._rows(self.PUSH)] = max(limits.acceleration, task.command) - free[COMMAND]
        p.h[self._rows(self.BRAKE)] = limits.comfortable_braking + free[COMMAND]
        return free

    def solve(self, task: SpeedTask, warm: FloatArray | None = None) -> SpeedPlan:
        """Return the plan for a task; ``found`` is False when the solver gave none."""
        free = self.build(task)
        solution = self.program.solve(warm)
        n = self.steps
        states = free + self.horizon.gain @ solution.z[:n]
        slack = solution.z[n:]
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

    def _rows(self, block: int) -> slice:
        return slice(block * self.steps, (block + 1) * self.steps)

    def _cost_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((n + self.SLACKS, n + self.SLACKS), dtype=bool)
        pattern[:n, :n] = True
        np.fill_diagonal(pattern, True)
        return pattern

    def _row_pattern(self, n: int) -> NDArray[np.bool_]:
        pattern = np.zeros((self.BLOCKS * n, n + self.SLACKS), dtype=bool)
        for block in range(self.BLOCKS):
            pattern[self._rows(block), :n] = np.tril(np.ones((n, n), dtype=bool))
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
        p.P[:n, :n] = 2.0 * (
            w.speed * (v.T * self.dt) @ v + w.acceleration * (a.T * self.dt) @ a + w.jerk * np.diag(self.dt)
        )
        squares = (w.violation_squared, w.violation_squared, 0.0, w.emergency_squared)
        p.P[range(n, n + self.SLACKS), range(n, n + self.SLACKS)] = 2.0 * np.array(squares)
        p.q[n:] = (w.violation, w.violation, w.headway, w.emergency)
        signed = {
            self.UPPER: s,
            self.LOWER: -s,
            self.HEADWAY: s + limits.headway * v,
            self.FAST: v,
            self.SLOW: -v,
            self.PUSH: c,
            self.BRAKE: -c,
        }
        for block, rows in signed.items():
            p.G[self._rows(block), :n] = rows
        for block, slack in self._softened():
            p.G[self._rows(block), n + slack] = -1.0
        p.lower[:n], p.upper[:n] = -limits.jerk, limits.jerk
        p.lower[n:] = 0.0
        p.upper[n + self.EMERGENCY] = limits.emergency_braking - limits.comfortable_braking
