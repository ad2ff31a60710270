"""The controller's last plan, moved to the present."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Command, EgoState
from controllers.velocity_obstacle.mpc.arithmetic import last_plan

FORGOTTEN_AFTER = 1.5
"""A plan older than this is no longer used as a guide [s]."""
COMMAND_SPACING = 0.05
"""Spacing of the commands in a sequence, fine enough to drive a long simulation step well too [s]."""


@dataclass(slots=True)
class PlanMemory:
    """The last plan: when it was made, its command, and positions and speeds at the horizon's times."""

    times: FloatArray
    made_at: float | None = None
    command: Command | None = None
    position: FloatArray | None = None
    speed: FloatArray | None = None
    shift: FloatArray | None = None
    """Planned movement across the road from where the ego was, left positive [m]."""
    _asked: tuple[float | None, float] | None = None
    _now: tuple[float, float] = (0.0, 0.0)
    # Command now, for the plan and the instant in ``_asked``; kept because it is needed several times a step.

    def keep(
        self, time: float, command: Command, position: FloatArray, speed: FloatArray, shift: FloatArray
    ) -> None:
        """Remember a plan."""
        self.made_at, self.command, self.position, self.speed = time, command, position, speed
        self.shift = shift

    def shifted_by(self, distance: float) -> float:
        """Return the time until the ego has moved ``distance`` across the road; inf if it will not [s]."""
        if self.shift is None:
            return float("inf")
        there = np.flatnonzero(np.sign(distance) * self.shift >= abs(distance))
        return float(self.times[there[0]]) if len(there) else float("inf")

    def age(self, time: float) -> float:
        """Return the time since the plan was made; inf without one [s]."""
        return time - self.made_at if self.made_at is not None else float("inf")

    def expected(self, ego: EgoState) -> tuple[FloatArray, FloatArray]:
        """Return positions (from now) and speeds of the last plan; constant speed without a fresh one."""
        age = self.age(ego.time)
        if self.position is None or self.speed is None or age > FORGOTTEN_AFTER:
            return ego.speed * self.times, np.full(len(self.times), ego.speed)
        return last_plan.moved(self.times, self.position, self.speed, age)

    def arrives(self, ego: EgoState, places: FloatArray) -> FloatArray:
        """Return when the last plan is at places ahead, shape (k,) [s]; its end for those beyond it."""
        position, _ = self.expected(ego)
        return np.asarray(np.interp(places, position, self.times))

    def commanded(self, ego: EgoState) -> tuple[float, float]:
        """Return the acceleration and steering angle commanded at this instant."""
        if self.command is None:
            return ego.acceleration, ego.steering
        if self._asked != (self.made_at, ego.time):
            i = _entry(self.command, self.age(ego.time))
            self._now = float(self.command.acceleration[i]), float(self.command.steering[i])
            self._asked = self.made_at, ego.time
        acceleration, steering = self._now
        # The vehicle departs from the command when it is at its limits, when SUMO holds it, or when the last
        # check overrides the plan.
        return (
            ego.acceleration if abs(acceleration - ego.acceleration) > 4.0 else acceleration,
            ego.steering if abs(steering - ego.steering) > 0.2 else steering,
        )

    def rest(self, time: float) -> Command | None:
        """Return the rest of the last command, as a command from now on."""
        return None if self.command is None else rest_of(self.command, self.age(time))


def rest_of(command: Command, age: float) -> Command:
    """Return the rest of a command given ``age`` seconds ago, as a command from now on."""
    i = _entry(command, age)
    times = np.maximum(command.times[i:] - age, 0.0)
    return Command(times, command.acceleration[i:], command.steering[i:])


def _entry(command: Command, age: float) -> int:
    return max(int(np.searchsorted(command.times, age + 1e-9)) - 1, 0)


def sampled_command(
    times: FloatArray,
    now: tuple[float, float],
    acceleration: FloatArray,
    steering: FloatArray,
    duration: float,
) -> Command:
    """Return the command that follows two profiles for ``duration``.

    Parameters
    ----------
    times : horizon, shape (N,) [s]
    now : commanded acceleration and steering angle at this instant
    acceleration, steering : the profiles at ``times``, linear in between
    duration : how long the command lasts [s]
    """
    profiles = last_plan.sampled(times, now[0], acceleration, now[1], steering, COMMAND_SPACING, duration)
    return Command(*profiles)
