"""The interface of a manner: how a pedestrian walks along the line after setting off."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from cosim.pedestrians.behaviour import Leg, RoadUser
from cosim.pedestrians.line import Line

SHORTEST_RAMP = 1e-6
"""Below this acceleration distance, pedestrians reach their speed at once [m]."""


@dataclass(frozen=True, slots=True)
class Pace:
    """A speed, and the distance over which it is reached with constant acceleration."""

    speed: float
    """[m/s]"""
    acceleration_distance: float = 0.0
    """[m]"""

    def legs(self, length: float) -> tuple[Leg, ...]:
        """Return a walk of a given length [m].

        The acceleration is v² / (2 s), so that the speed is v after the acceleration distance s.

        >>> Pace(2.0, 1.0).legs(5.0)
        (Leg(duration=1.0, speed=0.0, acceleration=2.0), Leg(duration=2.0, speed=2.0, acceleration=0.0))
        """
        ramp = self.acceleration_distance
        if ramp <= SHORTEST_RAMP:
            return (Leg(length / self.speed, self.speed),) if length > 0.0 else ()
        acceleration = self.speed**2 / (2.0 * ramp)
        if length <= ramp:
            return (Leg(math.sqrt(2.0 * length / acceleration), 0.0, acceleration),) if length > 0.0 else ()
        rest = (length - ramp) / self.speed
        first = Leg(self.speed / acceleration, 0.0, acceleration)
        return (first, Leg(rest, self.speed)) if rest > 0.0 else (first,)

    def time(self, length: float) -> float:
        """Return how long a walk of a given length takes [s].

        >>> Pace(2.0, 1.0).time(5.0)
        3.0
        """
        return sum(leg.duration for leg in self.legs(length))


class Manner(Protocol):
    """The manner in which a pedestrian walks along a line."""

    def legs(self, pace: Pace, length: float) -> tuple[Leg, ...]:
        """Return the walk planned at the start.

        Parameters
        ----------
        pace : speed and acceleration distance
        length : length of the path [m]
        """
        ...

    def react(
        self, legs: tuple[Leg, ...], elapsed: float, length: float, arrival: float
    ) -> tuple[Leg, ...] | None:
        """Return a new plan if an ego causes one; ``None`` to go on as planned.

        Parameters
        ----------
        legs, elapsed : the plan, and the time since its start [s]
        length : length of the path [m]
        arrival : time until the first ego that has not passed reaches the line; inf without one [s]
        """
        ...


def soonest_arrival(line: Line, egos: Sequence[RoadUser]) -> float:
    """Return the time until the first ego reaches the line; inf if none does [s]."""
    meetings = [(line.meeting(ego), ego) for ego in egos]
    return min(
        (met.arrival(ego) for met, ego in meetings if met is not None and met.along > 0.0), default=math.inf
    )
