"""Speed and steering in one quadratic program, with collision cones that couple them.

Variables are the inputs and slacks of the speed program, the steering rates and slack of the steering
program, and two slacks per pedestrian slot; the objective is the sum of both. Both programs are built
unchanged and copied in as blocks. The rows of the cones follow, linearised about a nominal plan.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.solve import Memory, solve
from controllers.velocity_obstacle.mpc.arithmetic.speed_program import POSITION, SPEED
from controllers.velocity_obstacle.mpc.arithmetic.steering_program import ACROSS, HEADING, STEERING_COMMAND
from controllers.velocity_obstacle.mpc.cone_rows import ConeRows, ConeSettings, Motion, Walkers, rows
from controllers.velocity_obstacle.mpc.lateral import LateralProgram, Response, SteeringPlan, SteeringTask
from controllers.velocity_obstacle.mpc.longitudinal import LongitudinalProgram, SpeedPlan, SpeedTask

NEAR = 1.0
"""Cone rows earlier than this have a slack of their own: velocities that soon can hardly be changed, and
violating them must not relax later rows [s]."""


@dataclass(frozen=True, slots=True)
class JointPlan:
    """Speed and steering plan; ``speed.cost`` is the whole objective, ``speed.slack`` includes the cones."""

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
        Which cone is used.
    slots
        Number of pedestrians that fit in; an empty slot costs nothing.
    """

    def __init__(
        self,
        speed: LongitudinalProgram,
        steering: LateralProgram,
        settings: ConeSettings,
        slots: int,
    ) -> None:
        self.speed, self.steering, self.settings, self.slots = speed, steering, settings, slots
        self.steps = speed.steps
        near = np.cumsum(speed.dt) < NEAR
        self._slacks = np.stack((near, ~near), axis=1)
        # First row and variable of the steering program, then of the cones.
        self._rows_at = (len(speed.problem.h), len(speed.problem.h) + len(steering.problem.h))
        self._variables_at = (len(speed.problem.q), len(speed.problem.q) + len(steering.problem.q))
        self.solver = speed.solver
        self.problem: Problem = blank(
            f"{speed.problem.objective} + {steering.problem.objective} + cones",
            _sizes(speed.problem.variables)
            | _sizes(steering.problem.variables)
            | {"relative velocity inside cones [m/s], soon and later": 2 * slots},
            _sizes(speed.problem.rows)
            | _sizes(steering.problem.rows)
            | {"relative velocity outside cones [m/s], softened": slots * self.steps},
        )
        self._place(constant=True)
        first, weights = self._variables_at[1], speed.weights
        slack = range(first, len(self.problem.q))
        self.problem.P[slack, slack] = 2.0 * weights.violation_squared
        self.problem.q[first:] = weights.violation
        self.problem.lower[first:] = 0.0
        for slot in range(slots):
            self.problem.G[self._slot(slot), self._slack(slot)] = np.where(self._slacks, -1.0, 0.0)

    def build(
        self, speed: SpeedTask, steering: SteeringTask, walkers: Walkers, nominal: Motion
    ) -> JointResponse:
        """Write both tasks, and the cones linearised about a nominal motion, into the program."""
        speed_free = self.speed.build(speed)
        response = self.steering.build(steering)
        self._place(constant=False)
        p, n = self.problem, self.steps
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
        start: FloatArray | None = None,
        memory: Memory | None = None,
    ) -> JointPlan:
        """Return both plans; ``found`` is False in both when they were not solved.

        ``start`` and ``memory`` as for :func:`controllers.optimisation.solve.solve`.
        """
        response = self.build(speed, steering, walkers, nominal)
        solution = solve(self.problem, self.solver, memory, start)
        n, split, end = self.steps, *self._variables_at
        jerks, rates, slack = solution.z[:split], solution.z[split:end], solution.z[end:]
        lane = response.steering.free + response.steering.gain @ rates[:n]
        cost = solution.cost + response.steering.cost
        road = self.speed.plan(speed, response.speed_free, jerks, cost, solution.solved)
        return JointPlan(
            road._replace(slack=max(road.slack, float(slack.max(initial=0.0)))),
            SteeringPlan(
                found=solution.solved,
                across=lane[ACROSS],
                heading_error=lane[HEADING],
                command=lane[STEERING_COMMAND],
                cost=self.steering.problem.cost(rates),
                slack=float(max(rates[n], 0.0)),
                inputs=rates,
            ),
        )

    def start(self, plan: JointPlan) -> FloatArray:
        """Return the variables of both plans, to start a solve from."""
        return np.concatenate((plan.speed.inputs, plan.steering.inputs, np.zeros(2 * self.slots)))

    def _place(self, constant: bool) -> None:
        """Copy the blocks of the two programs, with ``constant`` also those that never change."""
        row, variable = 0, 0
        for part in (self.speed.problem, self.steering.problem):
            m, n = len(part.h), len(part.q)
            rows_at, at = slice(row, row + m), slice(variable, variable + n)
            if constant:
                self.problem.lower[at] = part.lower
            self.problem.upper[at] = part.upper
            self.problem.P[at, at] = part.P
            self.problem.q[at] = part.q
            self.problem.G[rows_at, at] = part.G
            self.problem.h[rows_at] = part.h
            row, variable = row + m, variable + n

    def _slot(self, slot: int) -> slice:
        first = self._rows_at[1] + slot * self.steps
        return slice(first, first + self.steps)

    def _slack(self, slot: int) -> slice:
        first = self._variables_at[1] + 2 * slot
        return slice(first, first + 2)


def _sizes(blocks: Mapping[str, slice]) -> dict[str, int]:
    return {name: at.stop - at.start for name, at in blocks.items()}


def _rows(weights: FloatArray, gain: FloatArray) -> FloatArray:
    return np.asarray(weights[:, None] * gain)


def _shifted(weights: FloatArray, gain: FloatArray) -> FloatArray:
    """Return rows about the state one step earlier; the first step's is the present state, without inputs."""
    result = np.zeros_like(gain)
    result[1:] = weights[1:, None] * gain[:-1]
    return result


def _at_free_response(
    cones: ConeRows, nominal: Motion, speed_free: FloatArray, steering_free: FloatArray
) -> FloatArray:
    """Return the value of the linearised cones without any input, shape (m, N)."""
    speed = speed_free[SPEED] - nominal.speed
    heading = steering_free[HEADING] - nominal.heading
    value = cones.value + cones.position * (speed_free[POSITION] - nominal.position)
    value = value + cones.across * (steering_free[ACROSS] - nominal.across)
    value = value + cones.speed * speed + cones.heading * heading
    value[:, 1:] += cones.speed_before[:, 1:] * speed[:-1] + cones.heading_before[:, 1:] * heading[:-1]
    return np.asarray(value)
