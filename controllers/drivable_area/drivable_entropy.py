"""Entropy of the places in the reaction space at which the car meets pedestrians."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray


class EntropyMode(StrEnum):
    """How the probabilities become a cost."""

    PAPER = "paper"
    """−Σ ln P / S_z over the places with P > 0, as printed."""
    SHANNON = "shannon"
    """−Σ P ln P / S_z, Shannon's entropy."""
    RISK = "risk"
    """−ln(1 − P) of the probability of a collision."""


class EntropyAt(StrEnum):
    """The instant of a candidate at which the places of pedestrians count."""

    LARGEST = "largest"
    """The instant with the largest entropy."""
    MEETING = "meeting"
    """The instant at which the car is level with the first pedestrian in conflict, t_tcz of Eqs. (29) and
    (30); the entropy of a candidate that stops before is 0."""


LEAST_PROBABILITY = 1e-6
"""Smallest probability of no collision; −ln of it is the largest risk."""


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
    Eqs. (4)-(7) and (47) of [Wu2023]_. The paper prints Σ ln P, with which a certain meeting costs nothing
    and the least likely one most. The entropy is 0 if nobody is in the space or if the space has no area. For
    several pedestrians, P_j is the joint probability that one of them is in the space and at that place, so
    that Shannon's form includes the P ln P of Eq. (5).

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
