"""How probable it is that pedestrians are in the way, and the distance that this requires."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from controllers.arrays import FloatArray
from controllers.yielding.facing import Facing

LEAST_DEVIATION = 0.05
"""Least standard deviation of a pedestrian's place [m]."""
CERTAIN_SHARE = 0.5
"""Greatest probability of contact along the road that is ever allowed, so that no margin is negative [-]."""


@dataclass(frozen=True, slots=True)
class WalkingUncertainty:
    """How uncertain the places of pedestrians become.

    Parameters
    ----------
    pace : standard deviation of their velocity along either axis [m/s]
    place : standard deviation of their present place, in addition to that of the sensors [m]
    """

    pace: float
    place: float

    def deviation(self, told: FloatArray, times: FloatArray) -> FloatArray:
        """Return the standard deviations of the places, shape (n, K) [m].

        √(σ_place² + σ_told² + (σ_pace t)²)

        Parameters
        ----------
        told : standard deviation that the sensors report, shape (n,) [m]
        times : shape (K,) [s]
        """
        known = np.maximum(np.hypot(self.place, told), LEAST_DEVIATION)
        return np.asarray(np.hypot(known[:, None], self.pace * times))


@dataclass(frozen=True, slots=True)
class Tightening:
    """What a chance constraint requires of the position, for n pedestrians and K times."""

    counts: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    """Where the probability of being in the way is larger than the accepted risk, shape (n, K)."""
    margin: FloatArray
    """Distance along the road to the expected place, shape (n, K) [m]."""
    expected: FloatArray
    """Expected places along the road, shape (n, K) [m]."""


def tightening(
    facing: Facing, side_margin: float, times: FloatArray, unsure: WalkingUncertainty, risk: float
) -> Tightening:
    """Return what P(contact at a time) ≤ risk requires, with independent normal errors along and across.

    For a contact, the pedestrian has to be within the path's width, with probability p, and the bumper at
    their place. If p ≤ risk, nothing is required. Otherwise P(along) ≤ risk / p, which requires a margin of
    z(1 − risk / p) σ.

    Parameters
    ----------
    facing : who is in the way
    side_margin : margin by which a disc is grown across the way [m]
    times : shape (K,) [s]
    unsure : how the deviations grow
    risk : ε, risk accepted for each pedestrian at each time

    Notes
    -----
    This is the deterministic form of a chance constraint on a normal variable, as in [Blackmore2011]_; the
    sharing of the risk between the two axes is our own.
    """
    people, ego = facing.people, facing.perception.ego
    told = facing.perception.pedestrians.uncertainty[people.index]
    deviation = unsure.deviation(told, times)
    place = people.across[:, None] + people.across_speed[:, None] * times - ego.across
    width = 0.5 * ego.body.width + side_margin + people.radius[:, None]
    inside = ndtr((width - place) / deviation) - ndtr((-width - place) / deviation)
    allowed = np.minimum(risk / np.maximum(inside, 1e-12), CERTAIN_SHARE)
    margin = people.radius[:, None] + ndtri(1.0 - allowed) * deviation
    return Tightening(inside > risk, np.asarray(margin), people.along_at(times))
