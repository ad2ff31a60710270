"""Pedestrians on their way across choose their direction anew at every instant, and avoid meeting the car.

Beside what ``direction_model`` expects of those who stand at a kerb.
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
"""Who has less of the road ahead keeps the direction [m]."""
MOST_OBLIQUE: Final = math.sin(float(ANGLES[0]))
"""A smaller share of the pace across the road is a walk along it, in none of the alternatives."""


@dataclass(frozen=True, slots=True)
class Reaction:
    """How a choice made on the road differs from one at the kerb; values of our own.

    Parameters
    ----------
    habit : standard deviation of the change of direction [rad]
    refusal : what a direction costs, in units of utility, on which the car would be met
    margin : distance beside the car's body below which it would be [m]
    """

    habit: float = math.radians(15.0)
    refusal: float = 0.2
    margin: float = 0.5


class DirectionAnew:
    """Predicts by the model of directions, applied again to the rest of everybody's way.

    Pedestrians who walk across the road, between its kerbs, choose among the alternatives of the model for
    what is left of the road; the goal is where their present course leads to. A direction is the less
    probable the more it differs from the present one, and where it would meet a car that keeps its speed.
    They walk on at their pace in the most probable direction until they are over; ``reach`` is the distance
    walked times the spread of the probabilities. All others are expected to do as in ``direction_model``.

    Notes
    -----
    What [LiLuZhang]_ leaves out: there the direction is fixed at departure, whatever the car does.
    """

    def __init__(self, model: DirectionModel, reaction: Reaction | None = None) -> None:
        self._model = model
        self._reaction = reaction or Reaction()
        self._at_the_kerb = DirectionPrediction(model)

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return where everybody is most probably, and how sure that is."""
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
        """Return the probability of every direction of one pedestrian, shape (121,); they sum to 1.

        Parameters
        ----------
        perception : for the pedestrian and the car
        i : index of the pedestrian
        rest : width of the road that is left to cross [m]
        ahead : sign of the way over
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
        """Say in which directions the pedestrian is beside or before the car while it passes them."""
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
    """Say who walks across the road between its kerbs, shape (n,)."""
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
