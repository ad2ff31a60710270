"""Speed and steering in one quadratic program, with collision cones that couple them.

Variables are the jerks and slacks of the speed program, the steering rates and slack of the steering
program, and two slacks per pedestrian slot; the objective is the sum of both. The two programs are built as
they are and copied in blocks; below their rows stand those of the cones, linearised about a nominal plan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.conflicts.collision_cone import ConeRows, ConeSettings, Motion, Walkers, rows
from controllers.mpc.lateral import LateralProgram, Response, SteeringPlan, SteeringTask
from controllers.mpc.longitudinal import LongitudinalProgram, SpeedPlan, SpeedTask
from controllers.numerics.speed_program import POSITION, SPEED
from controllers.numerics.steering_program import ACROSS, HEADING, STEERING_COMMAND
from controllers.programs.qp import Program

FloatArray = NDArray[np.float64]


NEAR = 1.0
"""Velocities nearer ahead can hardly be changed any more. They have a slack of their own, so that their
violation does not excuse later ones [s]."""


@dataclass(frozen=True, slots=True)
class JointPlan:
    """Both plans; ``speed.cost`` is the whole objective, ``speed.slack`` counts the cones too."""

    speed: SpeedPlan
    steering: SteeringPlan


@dataclass(frozen=True, slots=True)
class JointResponse:
    """States as affine functions of both inputs, as ``build`` wrote them into the program."""

    speed_free: FloatArray
    steering: Response


class ConeProgram:
    """Builds and solves joint plans of one layout.

    Parameters
    ----------
    speed, steering
        The two programs; their horizons must be the same.
    settings
        Which cone.
    slots
        Pedestrians that fit in; a slot without one costs nothing.
    solver, tolerance, compiled
        As for :class:`controllers.programs.qp.Program`.
    """

    def __init__(
        self,
        speed: LongitudinalProgram,
        steering: LateralProgram,
        settings: ConeSettings,
        slots: int,
        solver: str = "osqp",
        tolerance: float = 1e-4,
        compiled: bool = False,
    ) -> None:
        self.speed, self.steering, self.settings, self.slots = speed, steering, settings, slots
        self.steps = speed.steps
        near = np.cumsum(speed.dt) < NEAR
        self._slacks = np.stack((near, ~near), axis=1)
        # First row and variable of the steering program, then of the cones.
        self._rows_at = (len(speed.program.h), len(speed.program.h) + len(steering.program.h))
        self._variables_at = (len(speed.program.q), len(speed.program.q) + len(steering.program.q))
        self.program = Program(
            self._cost_pattern(), self._row_pattern(), solver, tolerance, compiled=compiled
        )
        self._place(constant=True)
        first, weights = self._variables_at[1], speed.weights
        slack = range(first, len(self.program.q))
        self.program.P[slack, slack] = 2.0 * weights.violation_squared
        self.program.q[first:] = weights.violation
        self.program.lower[first:] = 0.0
        for slot in range(slots):
            self.program.G[self._slot(slot), self._slack(slot)] = np.where(self._slacks, -1.0, 0.0)

    def build(
        self, speed: SpeedTask, steering: SteeringTask, walkers: Walkers, nominal: Motion
    ) -> JointResponse:
        """Write both tasks and the cones about a nominal motion into the program."""
        speed_free = self.speed.build(speed)
        response = self.steering.build(steering)
        self._place(constant=False)
        p, n = self.program, self.steps
        p.h[self._rows_at[1] :] = np.inf
        cones = rows(self.settings, walkers, nominal)
        jerk, angle = slice(0, n), slice(self._variables_at[0], self._variables_at[0] + n)
        s, v = self.speed.horizon.gain[POSITION], self.speed.horizon.gain[SPEED]
        d, psi = response.gain[ACROSS], response.gain[HEADING]
        constant = _at_free_response(cones, nominal, speed_free, response.free)
        for slot in range(len(walkers.side)):
            at = self._slot(slot)
            p.G[at, jerk] = -_rows(cones.position[slot], s)
            p.G[at, jerk] -= _rows(cones.speed[slot], v) + _shifted(cones.speed_before[slot], v)
            p.G[at, angle] = -_rows(cones.across[slot], d)
            p.G[at, angle] -= _rows(cones.heading[slot], psi) + _shifted(cones.heading_before[slot], psi)
            p.h[at] = constant[slot]
        return JointResponse(speed_free, response)

    def solve(
        self,
        speed: SpeedTask,
        steering: SteeringTask,
        walkers: Walkers,
        nominal: Motion,
        warm: FloatArray | None = None,
    ) -> JointPlan:
        """Return both plans; ``found`` is False in both when the solver gave none."""
        response = self.build(speed, steering, walkers, nominal)
        solution = self.program.solve(warm)
        n, split, end = self.steps, *self._variables_at
        jerks, rates, slack = solution.z[:split], solution.z[split:end], solution.z[end:]
        lane = response.steering.free + response.steering.gain @ rates[:n]
        cost = solution.cost + response.steering.cost
        road = self.speed.plan(speed, response.speed_free, jerks, cost, solution.found)
        return JointPlan(
            road._replace(slack=max(road.slack, float(slack.max(initial=0.0)))),
            SteeringPlan(
                found=solution.found,
                across=lane[ACROSS],
                heading_error=lane[HEADING],
                command=lane[STEERING_COMMAND],
                cost=self.steering.program.cost(rates),
                slack=float(max(rates[n], 0.0)),
                inputs=rates,
            ),
        )

    def start(self, plan: JointPlan) -> FloatArray:
        """Return the variables of both plans, to start a solve from."""
        return np.concatenate((plan.speed.inputs, plan.steering.inputs, np.zeros(2 * self.slots)))

    def _place(self, constant: bool) -> None:
        """Copy the blocks of the two programs; those that never change only once."""
        row, variable = 0, 0
        for part in (self.speed.program, self.steering.program):
            m, n = len(part.h), len(part.q)
            rows_at, at = slice(row, row + m), slice(variable, variable + n)
            if constant:
                self.program.lower[at] = part.lower
            self.program.upper[at] = part.upper
            self.program.P[at, at] = part.P
            self.program.q[at] = part.q
            self.program.G[rows_at, at] = part.G
            self.program.h[rows_at] = part.h
            row, variable = row + m, variable + n

    def _slot(self, slot: int) -> slice:
        first = self._rows_at[1] + slot * self.steps
        return slice(first, first + self.steps)

    def _slack(self, slot: int) -> slice:
        first = self._variables_at[1] + 2 * slot
        return slice(first, first + 2)

    def _cost_pattern(self) -> NDArray[np.bool_]:
        split, end = self._variables_at
        pattern = np.eye(end + 2 * self.slots, dtype=bool)
        pattern[:split, :split] = self.speed.program.cost_pattern
        pattern[split:end, split:end] = self.steering.program.cost_pattern
        return pattern

    def _row_pattern(self) -> NDArray[np.bool_]:
        (speed_rows, rows_end), (split, end), n = self._rows_at, self._variables_at, self.steps
        pattern = np.zeros((rows_end + self.slots * n, end + 2 * self.slots), dtype=bool)
        pattern[:speed_rows, :split] = self.speed.program.row_pattern
        pattern[speed_rows:rows_end, split:end] = self.steering.program.row_pattern
        lower_triangle = np.tril(np.ones((n, n), dtype=bool))
        for slot in range(self.slots):
            pattern[self._slot(slot), :n] = lower_triangle
            pattern[self._slot(slot), split : split + n] = lower_triangle
            pattern[self._slot(slot), self._slack(slot)] = self._slacks
        return pattern


def _rows(weights: FloatArray, gain: FloatArray) -> FloatArray:
    return np.asarray(weights[:, None] * gain)


def _shifted(weights: FloatArray, gain: FloatArray) -> FloatArray:
    """Return rows about the state one time before; the present one depends on no input."""
    result = np.zeros_like(gain)
    result[1:] = weights[1:, None] * gain[:-1]
    return result


def _at_free_response(
    cones: ConeRows, nominal: Motion, speed_free: FloatArray, steering_free: FloatArray
) -> FloatArray:
    """Return the linearised cones' value where no input is given, shape (m, N)."""
    speed = speed_free[SPEED] - nominal.speed
    heading = steering_free[HEADING] - nominal.heading
    value = cones.value + cones.position * (speed_free[POSITION] - nominal.position)
    value = value + cones.across * (steering_free[ACROSS] - nominal.across)
    value = value + cones.speed * speed + cones.heading * heading
    value[:, 1:] += cones.speed_before[:, 1:] * speed[:-1] + cones.heading_before[:, 1:] * heading[:-1]
    return np.asarray(value)
