"""Manner ``steady``: the pedestrian walks at constant speed."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.pedestrians.behaviour import Leg
from cosim.pedestrians.manner import Pace


@dataclass(frozen=True, slots=True)
class Steady:
    """The pedestrian walks to the end of the path at constant speed, regardless of vehicles."""

    def legs(self, pace: Pace, length: float) -> tuple[Leg, ...]:
        """Return the walk."""
        return pace.legs(length)

    def react(
        self, legs: tuple[Leg, ...], elapsed: float, length: float, arrival: float
    ) -> tuple[Leg, ...] | None:
        """Return ``None``: the pedestrian does not react."""
        return None
