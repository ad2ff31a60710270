"""What counts as standing and walking, how long road users have stood, and how a car is kept standing."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import BoolArray
from controllers.interface import Pedestrians, Vehicles

STANDING = 0.05
"""Below this speed, a car whose speed is known as precisely as the ego's counts as standing [m/s]."""
VEHICLE_STANDING = 0.1
"""Below this speed, another vehicle counts as standing [m/s]."""
WALKING = 0.1
"""Above this speed, a pedestrian counts as walking [m/s]."""
HOLDING = -2.0
"""Acceleration command that keeps a standing car standing [m/s^2]."""
HOLDING_GENTLY = -0.5
"""Acceleration command that keeps a car standing whose smooth plan ends in a standstill [m/s^2]."""


def standing(vehicles: Vehicles) -> BoolArray:
    """Return which vehicles stand, shape (n,)."""
    return np.asarray(np.hypot(vehicles.along_speed, vehicles.across_speed) < VEHICLE_STANDING)


def walking(people: Pedestrians) -> BoolArray:
    """Return which pedestrians walk, shape (n,)."""
    return np.asarray(np.hypot(people.along_speed, people.across_speed) > WALKING)


@dataclass(slots=True)
class StoodSince:
    """Remembers since when each road user has stood."""

    _since: dict[str, float] = field(default_factory=dict)

    def look(self, names: Iterable[str], time: float) -> None:
        """Take note of all who stand at a time [s], and forget the others."""
        self._since = {name: self._since.get(name, time) for name in names}

    def stood(self, name: str, time: float) -> float:
        """Return how long a road user has stood; -inf if they did not stand at the last look [s]."""
        return time - self._since.get(name, math.inf)
