"""In which direction a pedestrian crosses a road without a crossing: a logit model over 121 directions.

A direction is the angle between the cars' direction and the pedestrian's, from 30° to 150°: below 90° the
pedestrian walks with the cars, above 90° towards them. It does not say from which side the pedestrian comes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from controllers.arrays import FloatArray

ANGLES: Final = np.deg2rad(np.arange(30.0, 151.0))
"""The alternative directions [rad]."""
WALKING_SPEED = 1.25
"""Speed at which the paper's pedestrians walk [m/s]."""
PAPER_WIDTH = 8.0
PAPER_FURTHEST = 20.0


@dataclass(frozen=True, slots=True)
class Errand:
    """Where a pedestrian at the kerb wants to go.

    Parameters
    ----------
    road_width : width from kerb to kerb, W_r [m]
    goal_along : distance of the goal along the road, in the direction of the cars [m]
    goal_beyond : distance of the goal behind the opposite kerb [m]
    """

    road_width: float = PAPER_WIDTH
    goal_along: float = 0.0
    goal_beyond: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.road_width < math.inf:
            raise ValueError(f"road_width = {self.road_width} must be greater than 0 and finite")
        if not (math.isfinite(self.goal_along) and math.isfinite(self.goal_beyond)):
            raise ValueError(f"the goal ({self.goal_along}, {self.goal_beyond}) must be finite")

    def lengths(self, angles: FloatArray = ANGLES) -> FloatArray:
        """Return the length of the way across the road, W_r / sin θ [m].

        >>> Errand(8.0).lengths(np.deg2rad([30.0, 90.0])).round(6).tolist()
        [16.0, 8.0]
        """
        return np.asarray(self.road_width / np.sin(angles))

    def remaining(self, angles: FloatArray = ANGLES) -> FloatArray:
        """Return the distance to the goal from where the pedestrian reaches the opposite kerb [m].

        >>> Errand(8.0, -5.0, 1.0).remaining(np.deg2rad([30.0])).round(2).tolist()
        [18.88]
        """
        return np.hypot(self.goal_along - self.road_width / np.tan(angles), self.goal_beyond)

    @property
    def bearing(self) -> float:
        """Direction from the start to the goal [rad]."""
        return math.atan2(self.road_width + self.goal_beyond, self.goal_along)

    @property
    def longest(self) -> float:
        """Longest way across the road, λ1 = W_r / sin 30° [m]."""
        return 2.0 * self.road_width

    @property
    def furthest(self) -> float:
        """Scale of the distance to the goal, λ2: 20 m for the paper's road of 8 m, else in proportion [m]."""
        return PAPER_FURTHEST / PAPER_WIDTH * self.road_width


Utility = Callable[[Errand, FloatArray], FloatArray]


def _root(values: FloatArray) -> FloatArray:
    return np.sqrt(np.maximum(values, 0.0))


LENGTH_UTILITIES: MappingProxyType[str, Utility] = MappingProxyType(
    {
        "linear": lambda errand, angles: 1.0 - errand.lengths(angles) / errand.longest,
        "scaled": lambda errand, angles: (
            (errand.longest - errand.lengths(angles)) / (errand.longest - errand.road_width)
        ),
        "squared": lambda errand, angles: 1.0 - (errand.lengths(angles) / errand.longest) ** 2,
        "circular": lambda errand, angles: _root(1.0 - (errand.lengths(angles) / errand.longest) ** 2),
    }
)
"""Interpretations of the paper's first utility, by name: how short the way across the road is."""

GOAL_UTILITIES: MappingProxyType[str, Utility] = MappingProxyType(
    {
        "linear": lambda errand, angles: 1.0 - errand.remaining(angles) / errand.furthest,
        "squared": lambda errand, angles: 1.0 - (errand.remaining(angles) / errand.furthest) ** 2,
        "gaussian": lambda errand, angles: np.exp(-((errand.remaining(angles) / errand.furthest) ** 2)),
        "circular": lambda errand, angles: _root(1.0 - (errand.remaining(angles) / errand.furthest) ** 2),
        "cosine": lambda errand, angles: np.cos(angles - errand.bearing),
        "angular": lambda errand, angles: 1.0 - np.abs(angles - errand.bearing) / np.deg2rad(120.0),
    }
)
"""Interpretations of the second utility, by name: how near the goal is once the road is crossed."""


@dataclass(frozen=True, slots=True)
class DirectionModel:
    """Utilities and choice probabilities.

    E = α U1 + (1 − α) U2 and P_i = exp(E_i / m) / Σ exp(E_j / m). This is what a predictor assumes. The
    simulated jaywalkers draw their direction from a model and parameters of their own, so that no forecast
    knows the truth.

    Parameters
    ----------
    length_weight : α, weight of the utility U1 of a short way
    scale : m; the smaller it is, the more certain the choice. It does not change the most probable direction
    length_utility : U1, one of ``LENGTH_UTILITIES``
    goal_utility : U2, one of ``GOAL_UTILITIES``

    Raises
    ------
    ValueError
        A weight outside [0, 1], a scale that is not positive, an unknown utility.

    Notes
    -----
    The model and α = 0.4 are those of [LiLuZhang]_. Its formulas for U1 and U2 are lost, and the
    interpretations here are not equivalent. The defaults are the simplest pair that, with the paper's weight,
    is within 2° of the most probable direction in the paper's example (100°). That is a fit, not a finding.
    The value of m is our own.

    >>> round(math.degrees(DirectionModel().most_probable(Errand(8.0, -5.0, 1.0))))
    102
    """

    length_weight: float = 0.4
    scale: float = 0.05
    length_utility: str = "scaled"
    goal_utility: str = "squared"

    def __post_init__(self) -> None:
        if not 0.0 <= self.length_weight <= 1.0:
            raise ValueError(f"length_weight = {self.length_weight} must be between 0 and 1")
        if not 0.0 < self.scale < math.inf:
            raise ValueError(f"scale = {self.scale} must be greater than 0 and finite")
        for name, value, known in (
            ("length_utility", self.length_utility, LENGTH_UTILITIES),
            ("goal_utility", self.goal_utility, GOAL_UTILITIES),
        ):
            if value not in known:
                raise ValueError(f"{name} = '{value}' is none of {', '.join(known)}")

    def utilities(self, errand: Errand, angles: FloatArray = ANGLES) -> FloatArray:
        """Return the utility of every direction, shape of ``angles``."""
        by_length = LENGTH_UTILITIES[self.length_utility](errand, angles)
        by_goal = GOAL_UTILITIES[self.goal_utility](errand, angles)
        return self.length_weight * by_length + (1.0 - self.length_weight) * by_goal

    def probabilities(self, errand: Errand) -> FloatArray:
        """Return the probability of every direction, shape (121,); they sum to 1."""
        utilities = self.utilities(errand)
        # The largest exponent is 0, so a small scale neither overflows nor divides by zero.
        weights = np.exp((utilities - utilities.max()) / self.scale)
        return np.asarray(weights / weights.sum())

    def most_probable(self, errand: Errand) -> float:
        """Return the most probable direction [rad]; of equal ones, the one nearest to straight across."""
        utilities = self.utilities(errand)
        best = np.flatnonzero(utilities >= utilities.max() - 1e-12)
        return float(ANGLES[best[np.argmin(np.abs(ANGLES[best] - 0.5 * np.pi))]])

    def spread(self, errand: Errand) -> float:
        """Return how far pedestrians end from the most probable place, per metre walked.

        This is the root mean square of the distance between the ends of two unit vectors, one in the most
        probable direction θ*, the other in a random one: √(2 (1 − Σ P_i cos(θ_i − θ*))).
        """
        turned = np.cos(ANGLES - self.most_probable(errand))
        return math.sqrt(max(2.0 * (1.0 - float(self.probabilities(errand) @ turned)), 0.0))


def velocity(angle: float, speed: float, *, from_left: bool) -> tuple[float, float]:
    """Return the velocity along the road and across it, left positive [m/s].

    Parameters
    ----------
    angle : direction θ [rad]
    speed : v [m/s]
    from_left : whether the pedestrian starts on the cars' left

    Notes
    -----
    It is (v cos θ, ∓ v sin θ), with minus for a start on the left [LiLuZhang]_.

    >>> velocity(0.5 * math.pi, 1.25, from_left=True)[1]
    -1.25
    """
    across = speed * math.sin(angle)
    return speed * math.cos(angle), -across if from_left else across
