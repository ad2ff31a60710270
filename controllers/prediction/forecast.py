"""Where pedestrians will be: the forecast that any controller may ask for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.interface import Perception


@dataclass(frozen=True, slots=True)
class Forecast:
    """Predicted places of n pedestrians at K times, in the route frame and order of the perception."""

    times: FloatArray
    """Times from now, ascending, shape (K,) [s]."""
    along: FloatArray
    """Shape (n, K) [m]."""
    across: FloatArray
    """Shape (n, K) [m]."""
    reach: FloatArray
    """How far from that place the pedestrian may be, shape (n, K); zero for a single prediction [m]."""

    def at(self, times: FloatArray) -> Forecast:
        """Return the forecast at other times: linear between the known times, constant before and after."""
        after = np.clip(np.searchsorted(self.times, times), 1, len(self.times) - 1)
        before = after - 1
        share = (times - self.times[before]) / (self.times[after] - self.times[before])
        share = np.clip(share, 0.0, 1.0)

        def between(values: FloatArray) -> FloatArray:
            return np.asarray(values[:, before] + share * (values[:, after] - values[:, before]))

        return Forecast(times, between(self.along), between(self.across), between(self.reach))

    def only(self, chosen: NDArray[np.int64]) -> Forecast:
        """Return the forecast of the pedestrians with the given indices."""
        return Forecast(self.times, self.along[chosen], self.across[chosen], self.reach[chosen])

    def velocities(self) -> tuple[FloatArray, FloatArray]:
        """Return the speeds along and across, shape (n, K) each [m/s]."""
        along, across = (np.gradient(values, self.times, axis=1) for values in (self.along, self.across))
        return np.asarray(along), np.asarray(across)


class Predictor(Protocol):
    """Predicts the pedestrians around an ego; one per ego, as it may have memory."""

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return where everybody in the perception will be at those times from now [s]."""
        ...
