"""What counts as standing and walking, for how long somebody has stood, and how a car is kept there."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import BoolArray
from controllers.interface import Pedestrians, Vehicles

STANDING = 0.05
"""A slower car stands, if its speed is known as well as the ego's is [m/s]."""
VEHICLE_STANDING = 0.1
"""Another vehicle that is slower stands [m/s]."""
WALKING = 0.1
"""A pedestrian who is faster walks [m/s]."""
HOLDING = -2.0
"""Keeps a standing car standing [m/s^2]."""
HOLDING_GENTLY = -0.5
"""Keeps a car standing whose plan is smooth and ends in a standstill [m/s^2]."""


def standing(vehicles: Vehicles) -> BoolArray:
    """Return which vehicles stand, shape (n,)."""
    return np.asarray(np.hypot(vehicles.along_speed, vehicles.across_speed) < VEHICLE_STANDING)


def walking(people: Pedestrians) -> BoolArray:
    """Return which pedestrians walk, shape (n,)."""
    return np.asarray(np.hypot(people.along_speed, people.across_speed) > WALKING)


@dataclass(slots=True)
class StoodSince:
    """Remembers since when each of some has stood."""

    _since: dict[str, float] = field(default_factory=dict)

    def look(self, names: Iterable[str], time: float) -> None:
        """Take note of all who stand at a time [s]; the others are forgotten."""
        self._since = {name: self._since.get(name, time) for name in names}

    def stood(self, name: str, time: float) -> float:
        """Return for how long somebody has stood; -inf for who did not stand when looked at last [s]."""
        return time - self._since.get(name, math.inf)
