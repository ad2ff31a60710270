"""How far egos look: far enough to stop for road users who have to be let go first.

In a town this is a constant; where roads are fast, it grows with their speed limit.
"""

from __future__ import annotations

from typing import NamedTuple

from cosim.sumo.network import Network
from cosim.sumo.yielding import stopping_distance

JUNCTIONS, PERSONS, VEHICLES = 60.0, 80.0, 120.0
"""Least distances: to junctions ahead of the front bumper, to people and vehicles around the ego [m]."""
REACTION, BRAKING = 0.5, 3.0
"""A fast ego looks as far as it needs to stop with this reaction time and braking [s, m/s^2]."""
IN_TIME = 8.5
"""The ego sees vehicles this long before they reach its way: most junctions are cleared sooner [s]."""


class Sight(NamedTuple):
    """How far all egos on a network look around themselves [m]."""

    persons: float
    vehicles: float


def sight(network: Network) -> Sight:
    """Return how far egos look, given the fastest roads that people cross and on which vehicles go first."""
    persons = max(PERSONS, _stop(network.fastest_crossed))
    return Sight(persons, foe_range(network.fastest_with_priority))


def foe_range(speed: float) -> float:
    """Return the distance from a conflict within which vehicles with this speed limit are considered [m].

    >>> [foe_range(speed) for speed in (8.0, 14.0, 28.0)]
    [120.0, 120.0, 238.0]
    """
    return max(VEHICLES, IN_TIME * speed)


def looked_ahead(speed: float) -> float:
    """Return how far ahead of its front bumper an ego of that speed looks at junctions [m].

    >>> [round(looked_ahead(speed)) for speed in (8.0, 13.89, 27.78)]
    [60, 60, 143]
    """
    return max(JUNCTIONS, _stop(speed))


def _stop(speed: float) -> float:
    return stopping_distance(speed, BRAKING, REACTION)
