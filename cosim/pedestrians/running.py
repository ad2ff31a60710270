"""Manner ``running``: the pedestrian starts to run at some point, or because an ego approaches."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cosim.pedestrians.behaviour import Leg, begun, travelled
from cosim.pedestrians.manner import Pace


@dataclass(frozen=True, slots=True)
class Running:
    """The pedestrian runs after a distance or when an ego is about to reach the line, whichever comes first.

    Parameters
    ----------
    speed : running speed [m/s]
    after : distance walked before running [m]
    ego_within : they run as soon as an ego would reach the line within this time [s]
    """

    speed: float
    after: float = math.inf
    ego_within: float = 0.0

    def legs(self, pace: Pace, length: float) -> tuple[Leg, ...]:
        """Return a walk that becomes a run."""
        if self.after >= length:
            return pace.legs(length)
        return (*pace.legs(self.after), Leg((length - self.after) / self.speed, self.speed))

    def react(
        self, legs: tuple[Leg, ...], elapsed: float, length: float, arrival: float
    ) -> tuple[Leg, ...] | None:
        """Return a plan that runs the rest if an ego is near and the pedestrian does not run yet."""
        way, speed = travelled(legs, elapsed)
        if arrival > self.ego_within or abs(speed - self.speed) < 1e-9 or way >= length - 1e-9:
            return None
        return (*begun(legs, elapsed), Leg((length - way) / self.speed, self.speed))
