"""Pedestrians on their way across choose their direction anew at every instant, and avoid meeting the car.

Pedestrians who stand at a kerb are predicted as in ``direction_model``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.interface import Perception
from controllers.prediction.direction_choice import ANGLES, DirectionModel, Errand
from controllers.prediction.direction_model import WALKING, DirectionPrediction, kerbs
from controllers.prediction.forecast import Forecast, Predictor

NEARLY_OVER = 0.5
"""Pedestrians with less than this of the road ahead keep their direction [m]."""
MOST_OBLIQUE: Final = math.sin(float(ANGLES[0]))
"""Pedestrians with a smaller share of their pace across the road walk along it, in none of the alternatives
[-]."""


@dataclass(frozen=True, slots=True)
class Reaction:
    """How a choice made on the road differs from one at the kerb; the values are our own.

    Parameters
    ----------
    habit : standard deviation of the change of direction [rad]
    refusal : cost of a direction in which the pedestrian would meet the car, in units of utility
    margin : pedestrians nearer than this beside the car's body would meet it [m]
    """

    habit: float = math.radians(15.0)
    refusal: float = 0.2
    margin: float = 0.5


class DirectionAnew:
    """Predicts by the model of directions, applied again to the rest of each pedestrian's way.

    Pedestrians who walk across the road, between its kerbs, choose among the alternatives of the model for
    the rest of the road; their goal is where their present course leads. A direction is less probable the
    more it differs from the present one, and if they would meet a car that keeps its speed. They walk on at
    their pace in the most probable direction until they have crossed; ``reach`` is the distance walked times
    the spread of the probabilities. All others are expected to behave as in ``direction_model``.

    Notes
    -----
    [LiLuZhang]_ leaves this out: there the direction is fixed at departure, whatever the car does.
    """

    def __init__(self, model: DirectionModel, reaction: Reaction | None = None) -> None:
        self._model = model
        self._reaction = reaction or Reaction()
        self._at_the_kerb = DirectionPrediction(model)

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return the most probable places of everybody, and how uncertain they are."""
        known = self._at_the_kerb.predict(perception, times)
        along, across, reach = known.along.copy(), known.across.copy(), known.reach.copy()
        people = perception.pedestrians
        right, left = kerbs(perception)
        for i in np.flatnonzero(_on_the_way_over(perception, right, left)).tolist():
            ahead = math.copysign(1.0, float(people.across_speed[i]))
            rest = float(left[i] - people.across[i] if ahead > 0.0 else people.across[i] - right[i])
            probabilities = self._probabilities(perception, i, rest, ahead)
            chosen = float(ANGLES[int(np.argmax(probabilities))])
            pace = math.hypot(float(people.along_speed[i]), float(people.across_speed[i]))
            walked = np.minimum(pace * times, rest / math.sin(chosen))
            along[i] = people.along[i] + walked * math.cos(chosen)
            across[i] = people.across[i] + ahead * walked * math.sin(chosen)
            turned = 1.0 - float(probabilities @ np.cos(ANGLES - chosen))
            reach[i] = math.sqrt(max(2.0 * turned, 0.0)) * walked
        return Forecast(times, along, across, reach)

    def _probabilities(self, perception: Perception, i: int, rest: float, ahead: float) -> FloatArray:
        """Return the probability of every direction for one pedestrian, shape (121,); they sum to 1.

        Parameters
        ----------
        perception : gives the pedestrian and the car
        i : index of the pedestrian
        rest : width of the road left to cross [m]
        ahead : sign of the movement across the road
        """
        people, own = perception.pedestrians, self._reaction
        present = math.atan2(abs(float(people.across_speed[i])), float(people.along_speed[i]))
        errand = Errand(rest, goal_along=rest / math.tan(present))
        utilities = self._model.utilities(errand)
        utilities = utilities - own.refusal * self._meets(perception, i, ahead)
        logs = (utilities - utilities.max()) / self._model.scale
        logs = logs - 0.5 * ((ANGLES - present) / own.habit) ** 2
        weights = np.exp(logs - logs.max())
        return np.asarray(weights / weights.sum())

    def _meets(self, perception: Perception, i: int, ahead: float) -> BoolArray:
        """Return in which directions the pedestrian would be in the car's way while it passes them."""
        people, ego = perception.pedestrians, perception.ego
        pace = math.hypot(float(people.along_speed[i]), float(people.across_speed[i]))
        over, onward = pace * np.sin(ANGLES), pace * np.cos(ANGLES)
        side = 0.5 * ego.body.width + float(people.radius[i]) + self._reaction.margin
        to_middle = ahead * (ego.across - float(people.across[i]))
        enters, leaves = (to_middle - side) / over, (to_middle + side) / over
        closing = np.maximum(ego.speed - onward, 0.1)
        gap = float(people.along[i]) - float(people.radius[i]) - ego.body.front
        arrives = np.maximum(gap, 0.0) / closing
        passed = (gap + 2.0 * float(people.radius[i]) + ego.body.length) / closing
        return np.asarray((leaves > 0.0) & (enters < passed) & (leaves > arrives) & (passed > 0.0))


def _on_the_way_over(perception: Perception, right: FloatArray, left: FloatArray) -> BoolArray:
    """Return who walks across the road between its kerbs and is not nearly over, shape (n,)."""
    people = perception.pedestrians
    pace = np.hypot(people.along_speed, people.across_speed)
    rest = np.where(people.across_speed > 0.0, left - people.across, people.across - right)
    return np.asarray(
        (pace >= WALKING)
        & (np.abs(people.across_speed) > MOST_OBLIQUE * pace)
        & (people.across > right)
        & (people.across < left)
        & (rest > NEARLY_OVER)
    )


def build() -> Predictor:
    """Build the predictor."""
    return DirectionAnew(DirectionModel())
