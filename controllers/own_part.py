"""A method's own part of a plan: whether the method applies, acts, changes anything, and is overruled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray

ACCELERATION = 0.2
"""Accelerations that differ by no more than this count as the same [m/s^2]."""
ANGLE = 0.005
"""Front-wheel angles that differ by no more than this count as the same [rad]."""


@dataclass(frozen=True, slots=True)
class OwnPart:
    """What a method does about pedestrians in one plan."""

    applies: bool
    """Whether the condition holds under which the method's source lets it act: for most methods, that a
    pedestrian is in conflict."""
    acts: bool
    """Whether the command carries out a plan that the method made for these pedestrians."""
    deviates: bool
    """Whether the command differs from what would be commanded without any pedestrian."""
    overridden: bool = False
    """Whether emergency braking, a last check or a declared fallback replaces the method's command."""


IDLE = OwnPart(applies=False, acts=False, deviates=False)
"""The method's part when no pedestrian is in conflict."""


def differ(first: FloatArray, second: FloatArray, by: float = ACCELERATION) -> bool:
    """Return whether two sequences of commands differ anywhere by more than a tolerance.

    >>> differ(np.array([0.0, -1.0]), np.array([0.0, -1.1]))
    False
    """
    return bool((np.abs(first - second) > by).any())
