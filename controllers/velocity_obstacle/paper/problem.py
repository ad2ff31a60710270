"""The optimisation problem of the velocity-obstacle paper: the least change of speed and wheel angle that
keeps every relative velocity out of the pedestrians' collision cones.

``minimise sum (dv - dv_wanted)^2 + w ddelta^2``, Eq. (6), over the inputs of an explicit-Euler bicycle,
subject to bounds of inputs, speed and turn (22)-(25), gaps to vehicles (12)-(15), a cone for every
pedestrian at every step (16)-(21), and an end state where one is given. On the paper's empty road the
wanted change of speed is zero; in traffic it is what the road and its vehicles require.

This module only states the problem. Constraints are margins that must not be negative, in blocks. A margin is
in metres, metres per second or tenths of a radian, so that a violation of one is large in every block.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.paper.cone_margins import (
    ConeGradients,
    People,
    cone_gradients,
    cone_margins,
)
from controllers.velocity_obstacle.paper.euler_bicycle import (
    ACROSS,
    ALONG,
    HEADING,
    SPEED,
    SPEED_CHANGE,
    STEERING,
    EulerBicycle,
)

PER_RADIAN = 10.0
"""Margins of angles are in tenths of a radian."""


@dataclass(frozen=True, slots=True)
class InputLimits:
    """Bounds (22) to (25).

    Notes
    -----
    The paper gives no values for (22) and (23); these leave its experiments 1 and 2 unchanged. (25) is
    printed with both ends at −10 degrees.
    """

    braking: float = 8.0
    """[m/s^2]"""
    acceleration: float = 8.0
    """[m/s^2]"""
    speed: float = 15.0
    """[m/s]"""
    steering_rate: float = np.radians(9.4)
    """[rad/s]"""
    turn_rate: float = np.radians(10.0)
    """Rate of change of the heading [rad/s]."""


@dataclass(frozen=True, slots=True)
class End:
    """State to reach after ``step``; ``None`` leaves a part of it free. From then on, the wheel is held."""

    step: int
    along: float | None = None
    across: float | None = None
    heading: float | None = None
    speed: float | None = None
    steering: float | None = None

    def targets(self) -> list[tuple[int, float, float]]:
        """Return index, value and scale of the states that are given."""
        wanted = (self.along, self.across, self.heading, self.speed, self.steering)
        scale = {HEADING: PER_RADIAN, STEERING: PER_RADIAN}
        return [(i, value, scale.get(i, 1.0)) for i, value in enumerate(wanted) if value is not None]


@dataclass(frozen=True, slots=True)
class Room:
    """Where the rear axle may be after each step; arrays of shape (n,), infinite where free."""

    ahead: FloatArray
    """Largest along position plus headway times speed, Eqs. (12) and (14) [m]."""
    behind: FloatArray
    """Least along position, Eqs. (13) and (15) [m]."""
    right: FloatArray
    left: FloatArray
    headway: float = 0.0
    """[s]"""


def all_room(steps: int) -> Room:
    """Return unlimited room."""
    free = np.full(steps, np.inf)
    return Room(free, -free, -free, free)


@dataclass(frozen=True, slots=True)
class AvoidanceProblem:
    """One problem to solve.

    Parameters
    ----------
    bicycle, start
        How the vehicle moves and its initial state; see :class:`EulerBicycle`.
    people
        Predicted pedestrians, and the side on which each is passed.
    room
        Room that vehicles and edges of the road leave.
    steers
        False if only the speed is free and the vehicle drives straight on along the lane.
    steering_weight
        Weight w of a change of the wheel angle, relative to a change of speed [(m/s)^2/rad^2]. The paper
        gives no value.
    wanted
        Changes of speed that traffic and road require, shape (n,) [m/s].
    reference_point
        Distance from the rear axle forward to the point that the cones are about [m].
    """

    bicycle: EulerBicycle
    start: FloatArray
    people: People
    room: Room
    limits: InputLimits = field(default_factory=InputLimits)
    cone: Cone = Cone.VO
    steers: bool = True
    steering_weight: float = 1.0
    wanted: FloatArray | None = None
    end: End | None = None
    reference_point: float = 0.0

    @property
    def steps(self) -> int:
        """Number of steps n."""
        return len(self.room.ahead)

    @property
    def weights(self) -> FloatArray:
        """Weights of the inputs in the objective, shape (2, 1)."""
        return np.array([[1.0], [self.steering_weight]])

    def passed(self, side: FloatArray) -> AvoidanceProblem:
        """Return the problem with pedestrians passed on the given sides, shape (m,)."""
        return replace(self, people=replace(self.people, side=side))

    def wanted_inputs(self) -> FloatArray:
        """Return the inputs that cost nothing, shape (2, n)."""
        inputs = np.zeros((2, self.steps))
        if self.wanted is not None:
            inputs[SPEED_CHANGE] = self.wanted
        return inputs

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and highest inputs, shape (2, n) each, Eqs. (22) and (24)."""
        step, limits, n = self.bicycle.step, self.limits, self.steps
        turn = np.full(n, limits.steering_rate * step if self.steers else 0.0)
        if self.end is not None:
            turn[self.end.step :] = 0.0
        return (
            np.stack([np.full(n, -limits.braking * step), -turn]),
            np.stack([np.full(n, limits.acceleration * step), turn]),
        )

    def top_speed(self) -> float:
        """Return the highest speed (23); a vehicle that is already faster need not slow down [m/s]."""
        return max(self.limits.speed, float(self.start[SPEED]))

    def states(self, inputs: FloatArray) -> FloatArray:
        """Return the states, shape (..., 5, n + 1)."""
        return self.bicycle.states(self.start, inputs)

    def cost(self, inputs: FloatArray) -> FloatArray:
        """Return the objective J of inputs of shape (..., 2, n)."""
        return np.asarray((self.weights * (inputs - self.wanted_inputs()) ** 2).sum(axis=(-2, -1)))


@dataclass(frozen=True, slots=True)
class Margins:
    """How far every constraint is from being violated, along the last axis; see the module's docstring."""

    people: FloatArray
    ahead: FloatArray
    behind: FloatArray
    road: FloatArray
    """Edges, turn and speed."""
    end: FloatArray

    def blocks(self) -> tuple[FloatArray, ...]:
        """Return all blocks in order."""
        return self.people, self.ahead, self.behind, self.road, self.end

    def violations(self, steps: int) -> FloatArray:
        """Return the largest violation of the cones at each step, then of each other block."""
        people, *others = (np.maximum(-block, 0.0) for block in self.blocks())
        by_step = people.reshape(*people.shape[:-1], -1, steps).max(axis=-2, initial=0.0)
        largest = [block.max(axis=-1, initial=0.0, keepdims=True) for block in others]
        return np.concatenate((by_step, *largest), axis=-1)


def margins(problem: AvoidanceProblem, states: FloatArray) -> Margins:
    """Return the margins of motions, states of shape (..., 5, n + 1)."""
    room, n = problem.room, problem.steps
    after = states[..., 1:]
    speed, heading = after[..., SPEED, :], states[..., HEADING, :]
    turn = PER_RADIAN * np.diff(heading, axis=-1)
    most = PER_RADIAN * problem.limits.turn_rate * problem.bicycle.step
    edges = [
        room.left - after[..., ACROSS, :],
        after[..., ACROSS, :] - room.right,
        most - turn,
        most + turn,
        speed,
        problem.top_speed() - speed,
    ]
    targets = problem.end.targets() if problem.end is not None else []
    at = after[..., (problem.end.step if problem.end is not None else n) - 1]
    errors = [scale * (at[..., i] - value) for i, value, scale in targets]
    both = [sign * error for error in errors for sign in (1.0, -1.0)]
    return Margins(
        people=cone_margins(problem.cone, problem.people, states, problem.reference_point),
        ahead=room.ahead - after[..., ALONG, :] - room.headway * speed,
        behind=after[..., ALONG, :] - room.behind,
        road=np.concatenate(edges, axis=-1),
        end=np.stack(both, axis=-1) if both else np.zeros((*states.shape[:-2], 0)),
    )


def gradients(problem: AvoidanceProblem, states: FloatArray) -> Margins:
    """Return the derivatives of one motion's margins by its inputs, shape (rows, 2 n) for every block."""
    gain = problem.bicycle.sensitivities(states)
    n = problem.steps
    turn = PER_RADIAN * np.diff(gain[HEADING], axis=0, prepend=np.zeros((1, 2 * n)))
    edges = [-gain[ACROSS], gain[ACROSS], -turn, turn, gain[SPEED], -gain[SPEED]]
    targets = problem.end.targets() if problem.end is not None else []
    at = gain[:, (problem.end.step if problem.end is not None else n) - 1]
    both = [sign * scale * at[i] for i, _, scale in targets for sign in (1.0, -1.0)]
    cones = cone_gradients(problem.cone, problem.people, states, problem.reference_point)
    return Margins(
        people=_chained(cones, gain),
        ahead=-gain[ALONG] - problem.room.headway * gain[SPEED],
        behind=gain[ALONG],
        road=np.concatenate(edges),
        end=np.stack(both) if both else np.zeros((0, 2 * n)),
    )


def _chained(cones: ConeGradients, gain: FloatArray) -> FloatArray:
    """Return the derivatives of the cones by the inputs, one row for each pedestrian and step."""
    before = np.concatenate((np.zeros_like(gain[:, :1]), gain[:, :-1]), axis=1)
    rows = (
        cones.along[..., None] * gain[ALONG]
        + cones.across[..., None] * gain[ACROSS]
        + cones.heading[..., None] * gain[HEADING]
        + cones.speed[..., None] * gain[SPEED]
        + cones.heading_before[..., None] * before[HEADING]
        + cones.speed_before[..., None] * before[SPEED]
    )
    return np.asarray(rows.reshape(-1, gain.shape[-1]))
