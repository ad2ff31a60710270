"""What of a plan is a method's own doing: whether it applies, acts, changes anything, and is overruled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray

ACCELERATION = 0.2
"""Commands that differ by less are the same [m/s^2]."""
ANGLE = 0.005
"""Front-wheel angles that differ by less are the same [rad]."""


@dataclass(frozen=True, slots=True)
class OwnPart:
    """What a method does about pedestrians in one plan."""

    applies: bool
    """What its source demands for it to act holds: for most methods that somebody is in conflict."""
    acts: bool
    """The command carries out a plan that the method made for these pedestrians."""
    deviates: bool
    """The command differs from what would be commanded without any pedestrian."""
    overridden: bool = False
    """Emergency braking, a last check or a declared fallback has the last word instead."""


IDLE = OwnPart(applies=False, acts=False, deviates=False)
"""Nobody is in conflict."""


def differ(first: FloatArray, second: FloatArray, by: float = ACCELERATION) -> bool:
    """Return whether two sequences of commands differ anywhere by more than what does not matter.

    >>> differ(np.array([0.0, -1.0]), np.array([0.0, -1.1]))
    False
    """
    return bool((np.abs(first - second) > by).any())
