"""Pedestrians waiting at a kerb cross in the most probable direction; walking ones keep their direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.interface import Perception
from controllers.prediction.direction_choice import WALKING_SPEED, DirectionModel, Errand, velocity
from controllers.prediction.forecast import Forecast, Predictor

WALKING = 0.2
"""Below this speed, a pedestrian counts as standing [m/s]."""
BESIDE_ROAD = 1.0
"""Pedestrians who stand less than this beside the road are at its kerb … [m]"""
ON_ROAD = 0.5
"""… and so are those who stand on it, less than this from its end [m]."""


class DirectionPrediction:
    """Predicts by the model of directions when the goal is not known.

    - Walking pedestrians have chosen already and are expected to keep speed and direction; ``reach`` is 0.
    - Pedestrians who stand at the kerb, or wait where a crossing begins, are expected to step out now and to
      walk at ``speed`` in the most probable direction for a goal straight across, until they have crossed.
      ``reach`` is the distance walked times the spread of the distribution.
    - Pedestrians who stand anywhere else are expected to stay.

    Parameters
    ----------
    model : model of the choice
    speed : speed of those who step out [m/s]

    Notes
    -----
    [LiLuZhang]_ fixes the direction at departure. The paper knows the goal; a car does not, so "straight
    across" replaces it. The kerbs are those of the pedestrian's next crossing, or else the ends of the lanes
    that the ego may use.
    """

    def __init__(self, model: DirectionModel, speed: float = WALKING_SPEED) -> None:
        self._model = model
        self._speed = speed

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return the most probable places of everybody, and how uncertain they are."""
        people = perception.pedestrians
        along_speed, across_speed = people.along_speed.copy(), people.across_speed.copy()
        until, spread = np.full(len(people), np.inf), np.zeros(len(people))
        right, left = kerbs(perception)
        for i in _about_to_cross(perception, right, left):
            errand = Errand(float(left[i] - right[i]))
            angle = self._model.most_probable(errand)
            from_left = bool(people.across[i] > 0.5 * (right[i] + left[i]))
            along_speed[i], across_speed[i] = velocity(angle, self._speed, from_left=from_left)
            beyond = float(people.across[i] - right[i] if from_left else left[i] - people.across[i])
            until[i] = beyond / abs(across_speed[i])
            spread[i] = self._model.spread(errand) * self._speed
        walked = np.minimum(times, until[:, None])
        return Forecast(
            times,
            people.along[:, None] + along_speed[:, None] * walked,
            people.across[:, None] + across_speed[:, None] * walked,
            spread[:, None] * walked,
        )


def kerbs(perception: Perception) -> tuple[FloatArray, FloatArray]:
    """Return the right and left end of the road where each pedestrian is, shape (n,) each [m]."""
    road, people = perception.road, perception.pedestrians
    # The last entry, at index −1, is for pedestrians at no crossing.
    right = np.array([*(crossing.right for crossing in road.crossings), road.right_edge])
    left = np.array([*(crossing.left for crossing in road.crossings), road.left_edge])
    return right[people.crossing], left[people.crossing]


def _about_to_cross(perception: Perception, right: FloatArray, left: FloatArray) -> NDArray[np.int64]:
    """Return which pedestrians stand at a kerb, by index."""
    people = perception.pedestrians
    standing = np.hypot(people.along_speed, people.across_speed) < WALKING
    outside = np.maximum(right - people.across, people.across - left)
    near = (outside < BESIDE_ROAD) | people.waiting
    return np.flatnonzero(standing & near & (outside > -ON_ROAD) & (left > right))


def build() -> Predictor:
    """Build the predictor."""
    return DirectionPrediction(DirectionModel())
