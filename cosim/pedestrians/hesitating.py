"""Manner ``hesitating``: the pedestrian stops on the way and then walks on."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.pedestrians.behaviour import Leg
from cosim.pedestrians.manner import Pace


@dataclass(frozen=True, slots=True)
class Hesitating:
    """The pedestrian stands for ``pause`` [s] after walking ``after`` [m]."""

    after: float
    pause: float

    def legs(self, pace: Pace, length: float) -> tuple[Leg, ...]:
        """Return a walk with a pause; a walk that ends before the pause has none."""
        if self.after >= length:
            return pace.legs(length)
        return (*pace.legs(self.after), Leg(self.pause, 0.0), *pace.legs(length - self.after))

    def react(
        self, legs: tuple[Leg, ...], elapsed: float, length: float, arrival: float
    ) -> tuple[Leg, ...] | None:
        """Return ``None``: the pedestrian does not react."""
        return None
