"""Many random walks, by a Markov chain of walking speeds and a social force away from the car."""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import EgoState, Perception
from controllers.prediction.forecast import Forecast, Predictor
from controllers.prediction.social_force_model import CarOutline, SocialForceModel, Walkers, aims_of

LONGEST_STEP = 0.1
"""Longest time step of a random walk [s]."""
WITHIN = 2.0
"""Reach of a forecast, as a multiple of the standard deviation [-]."""


class SocialForcePrediction:
    """Predicts the mean of random walks, and how far they spread.

    The ego is assumed to keep its speed and its place across the road. Pedestrians keep pace and direction on
    average; those who stand remain standing until the car comes near. Every forecast draws the same random
    numbers, so that forecasts do not jitter from one to the next.

    Parameters
    ----------
    model : model of walking
    walks : number of random walks per pedestrian
    seed : seed of the random numbers
    """

    def __init__(self, model: SocialForceModel, walks: int, seed: int) -> None:
        self._model = model
        self._walks = walks
        self._seed = seed

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return mean places; ``reach`` is twice the standard deviation of the places."""
        people, ego = perception.pedestrians, perception.ego
        drawn = np.random.default_rng(self._seed)
        shape = (len(people), self._walks)
        walkers = Walkers(*(np.repeat(one[:, None], self._walks, axis=1) for one in _columns(perception)))
        aims = aims_of(people.along_speed[:, None], people.across_speed[:, None])
        along, across, reach = (np.zeros((len(people), len(times))) for _ in range(3))
        now = 0.0
        for k, time in enumerate(times):
            steps = max(math.ceil((time - now) / LONGEST_STEP - 1e-9), 0)
            for index in range(steps):
                at = now + (index + 0.5) * (time - now) / steps
                car = _car(ego, at)
                walkers = self._model.walk(
                    walkers, aims, car, (time - now) / steps, drawn.standard_normal(shape)
                )
            now = max(float(time), now)
            along[:, k], across[:, k] = walkers.x.mean(axis=1), walkers.y.mean(axis=1)
            reach[:, k] = WITHIN * np.hypot(walkers.x.std(axis=1), walkers.y.std(axis=1))
        return Forecast(times, along, across, reach)


def _columns(perception: Perception) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    people = perception.pedestrians
    return people.along, people.across, people.along_speed, people.across_speed


def _car(ego: EgoState, time: float) -> CarOutline:
    """Return the ego as it will be after a time [s] if it keeps its speed and its place across the road."""
    body = ego.body
    middle = 0.5 * body.length - body.rear_overhang
    return CarOutline(
        ego.speed * time + middle,
        ego.across,
        ego.heading_error,
        0.5 * max(body.length - body.width, 0.0),
    )


def build(seed: int = 1, *, walks: int = 24) -> Predictor:
    """Build the predictor.

    Parameters
    ----------
    seed : seed of the random walks
    walks : number of random walks per pedestrian

    Raises
    ------
    ValueError
        If there is no walk.
    """
    if walks < 1:
        raise ValueError(f"walks = {walks} must be at least 1")
    return SocialForcePrediction(SocialForceModel(), walks, seed)
