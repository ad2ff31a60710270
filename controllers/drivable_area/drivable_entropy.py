"""How uncertain it is where in the reaction space pedestrians are met."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray


class EntropyMode(StrEnum):
    """What the probabilities cost."""

    PAPER = "paper"
    """−Σ ln P / S_z over the places with P > 0, as printed."""
    SHANNON = "shannon"
    """−Σ P ln P / S_z, the entropy proper."""
    RISK = "risk"
    """−ln(1 − P) of the probability of a collision."""


class EntropyAt(StrEnum):
    """At which instant of a candidate the places of pedestrians are looked at."""

    LARGEST = "largest"
    """At each, of which the one with the largest entropy counts."""
    MEETING = "meeting"
    """When the car is level with the first pedestrian in conflict, t_tcz of Eqs. (29) and (30); 0 for a
    candidate that stops before."""


LEAST_PROBABILITY = 1e-6
"""Of no collision; −ln of it bounds the risk."""


def entropy_cost(
    places: FloatArray, collision: FloatArray, area: FloatArray | float, mode: EntropyMode
) -> FloatArray:
    """Return the entropy of meetings in the reaction space.

    Parameters
    ----------
    places : P_j, probability of each place in the reaction space, shape (…, m); they need not add up to 1
    collision : probability of a collision, shape (…)
    area : S_z, shape (…) [m^2]
    mode : see :class:`EntropyMode`

    Notes
    -----
    Eqs. (4)-(7) and (47) of [Wu2023]_. Printed is Σ ln P: a certain meeting costs nothing and the least
    likely one most. 0 where nobody is in the space, and where the space has no area. For several
    pedestrians P_j is the joint probability that one of them is in the space and at that place, so that
    Shannon's form includes the P ln P of Eq. (5).

    >>> float(entropy_cost(np.array([0.5, 0.5]), np.zeros(()), 1.0, EntropyMode.SHANNON).round(4))
    0.6931
    """
    if mode is EntropyMode.RISK:
        return np.asarray(-np.log(np.clip(1.0 - collision, LEAST_PROBABILITY, 1.0)))
    logarithm = np.log(np.where(places > 0.0, places, 1.0))
    weight = places if mode is EntropyMode.SHANNON else 1.0
    total = np.abs(weight * logarithm).sum(axis=-1)
    return np.asarray(
        np.where(np.asarray(area) > 0.0, total / np.where(np.asarray(area) > 0.0, area, 1.0), 0.0)
    )
