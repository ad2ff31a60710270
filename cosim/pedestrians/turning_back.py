"""Manner ``turning_back``: the pedestrian turns around on the way and goes back to the start."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cosim.pedestrians.behaviour import Leg, begun, travelled
from cosim.pedestrians.manner import Pace


@dataclass(frozen=True, slots=True)
class TurningBack:
    """The pedestrian turns after a distance or when an ego is about to reach the line, whichever comes first.

    Parameters
    ----------
    after : distance walked before turning [m]
    pause : standing time before going back [s]
    speed : speed of going back; ``None`` for the speed so far [m/s]
    ego_within : they turn as soon as an ego would reach the line within this time [s]
    """

    after: float = math.inf
    pause: float = 0.0
    speed: float | None = None
    ego_within: float = 0.0

    def legs(self, pace: Pace, length: float) -> tuple[Leg, ...]:
        """Return a walk there and back; a path that ends before the turn is walked to its end."""
        if self.after >= length:
            return pace.legs(length)
        return (*pace.legs(self.after), *self._back(self.after, pace.speed))

    def react(
        self, legs: tuple[Leg, ...], elapsed: float, length: float, arrival: float
    ) -> tuple[Leg, ...] | None:
        """Return a plan that turns back if an ego is near and the pedestrian has not turned yet."""
        way, speed = travelled(legs, elapsed)
        turned = any(leg.speed < 0.0 for leg in legs) and speed <= 0.0
        if arrival > self.ego_within or turned or way >= length - 1e-9 or way <= 0.0:
            return None
        came = max(leg.after(leg.duration)[1] for leg in legs)
        return (*begun(legs, elapsed), *self._back(way, came))

    def _back(self, way: float, came: float) -> tuple[Leg, ...]:
        speed = came if self.speed is None else self.speed
        pause = (Leg(self.pause, 0.0),) if self.pause > 0.0 else ()
        return (*pause, Leg(way / speed, -speed))
