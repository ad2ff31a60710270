"""All pedestrians keep their present velocities."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Perception
from controllers.prediction.forecast import Forecast, Predictor


class ConstantVelocity:
    """Predicts p(t) = p(0) + v t."""

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return where everybody is if they keep their velocities."""
        people = perception.pedestrians
        along = people.along[:, None] + people.along_speed[:, None] * times
        across = people.across[:, None] + people.across_speed[:, None] * times
        return Forecast(times, along, across, np.zeros_like(along))


def build() -> Predictor:
    """Build the predictor."""
    return ConstantVelocity()
