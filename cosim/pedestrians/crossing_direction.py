"""The direction in which a pedestrian crosses away from crossings: a logit model over 121 directions.

A direction is the angle between the way the cars drive and the way the pedestrian walks, from 30° to 150°:
below 90° they walk along with the cars, above it towards them. It does not say from which side they come.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from cosim.arrays import FloatArray

ANGLES: Final = np.deg2rad(np.arange(30.0, 151.0))
"""The directions to choose from [rad]."""
FURTHEST = 2.5
"""Scale of the distance to the goal, in widths of the road: 20 m for the paper's 8 m."""


@dataclass(frozen=True, slots=True)
class CrossingDirection:
    """E = α U1 + (1 − α) U2, P_i = exp(E_i / m) / Σ exp(E_j / m): U1 favours short ways, U2 near goals.

    This model moves the simulated pedestrians. Controllers that predict a choice of direction have a model
    and parameters of their own (``controllers/prediction/direction_choice.py``), which must not be used
    here: the controllers would know the truth. The default values of both are the same, so that published
    results can be reproduced.

    Parameters
    ----------
    length_weight : α, the weight of the utility U1 of a short way
    scale : m; the smaller it is, the more certain the choice

    Notes
    -----
    The model and α = 0.4 are from [LiLuZhang]_. The paper's formulas of U1 and U2 are not available. Those
    used here are our own: U1 = (λ1 − L) / (λ1 − W), with the length L of the way over a road of width W and
    the longest way λ1 = 2 W; and U2 = 1 − (d / λ2)², with λ2 = 2.5 W and the distance d to the goal from
    the point where the pedestrian reaches the opposite kerb. The value of m is our own, too.
    """

    length_weight: float = 0.4
    scale: float = 0.05

    def probabilities(self, width: float, goal_along: float, goal_beyond: float) -> FloatArray:
        """Return the probability of every direction, shape (121,); they sum to 1.

        Parameters
        ----------
        width : width of the road from kerb to kerb [m]
        goal_along : distance to the goal along the road, in the direction of the cars [m]
        goal_beyond : distance of the goal behind the opposite kerb [m]
        """
        length = width / np.sin(ANGLES)
        distance = np.hypot(goal_along - width / np.tan(ANGLES), goal_beyond)
        short = (2.0 * width - length) / (2.0 * width - width)
        near = 1.0 - (distance / (FURTHEST * width)) ** 2
        utility = self.length_weight * short + (1.0 - self.length_weight) * near
        # The largest exponent is 0, so a small scale neither overflows nor divides by zero.
        weights = np.exp((utility - utility.max()) / self.scale)
        return np.asarray(weights / weights.sum())

    def draw(
        self, width: float, goal_along: float, goal_beyond: float, generator: np.random.Generator
    ) -> float:
        """Return a direction drawn from the probabilities [rad]."""
        return float(generator.choice(ANGLES, p=self.probabilities(width, goal_along, goal_beyond)))
