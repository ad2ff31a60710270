"""The state that an ego will be in once its commands under way have taken effect.

A drive that follows its command with a dead time and a first-order lag T moves like the double integrator of
the command, only later. With v + T a as the speed and s + T v as the position, and with the commands under
way added, there is no delay left to plan for.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState


@dataclass(frozen=True, slots=True)
class PredictedState:
    """State in which plans begin."""

    speed: float
    """[m/s]"""
    ahead: float
    """How far the state is ahead of the present position [m]."""
    delay: float
    """Time until the ego gets there, if its speed is constant [s]."""

    def gap(self, gap: float, speed: float) -> float:
        """Return the gap left in that state to an obstacle with a given gap and speed now [m]."""
        return gap - self.ahead + speed * self.delay


@dataclass(slots=True)
class CommandHistory:
    """The accelerations commanded recently, as pieces of constant acceleration; one per ego."""

    _begins: list[float] = field(default_factory=list)
    _values: list[float] = field(default_factory=list)

    def add(self, time: float, times: FloatArray, acceleration: FloatArray) -> None:
        """Remember a command given at a time; from then on, it replaces earlier commands."""
        kept = [i for i, begin in enumerate(self._begins) if begin < time - 1e-9]
        # One piece that began long ago is enough to know what has been commanded since then.
        first = max((i for i in kept if self._begins[i] < time - 5.0), default=0)
        self._begins = [self._begins[i] for i in kept[first:]] + (time + times).tolist()
        self._values = [self._values[i] for i in kept[first:]] + acceleration.tolist()

    def last(self, time: float) -> float:
        """Return the acceleration commanded just before a time; 0 before the first command [m/s^2]."""
        before = int(np.searchsorted(self._begins, time - 1e-9)) - 1
        return self._values[before] if before >= 0 else 0.0

    def since(self, begin: float, end: float) -> list[tuple[float, float]]:
        """Return durations and accelerations of the pieces between two times [s, m/s^2]."""
        edges = [begin, *(one for one in self._begins if begin < one < end), end]
        return [
            (after - before, self.last(0.5 * (before + after)))
            for before, after in itertools.pairwise(edges)
            if after > before
        ]


def predicted_state(ego: EgoState, delay: float, history: CommandHistory) -> PredictedState:
    """Return the state to plan from.

    With the drive's lag T, its speed is v + T a and its position is s + T v. The part of the delay beyond the
    lag is dead time, in which commands given before now are still to take effect.

    Parameters
    ----------
    ego : present state of the ego
    delay : time from a command to its effect, lag included; if shorter than the lag, it counts as the lag [s]
    history : commands so far
    """
    lag = ego.drive.drive_lag
    dead = max(delay - lag, 0.0)
    speed = max(ego.speed + lag * ego.acceleration, 0.0)
    ahead = lag * ego.speed
    for duration, acceleration in history.since(ego.time - dead, ego.time) if dead > 0.0 else ():
        end = speed + acceleration * duration
        if end < 0.0:
            ahead += 0.5 * speed**2 / -acceleration
        else:
            ahead += 0.5 * (speed + end) * duration
        speed = max(end, 0.0)
    return PredictedState(speed, ahead, lag + dead)
