"""Where pedestrians will be, as any controller may ask it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from controllers.interface import FloatArray, Perception


@dataclass(frozen=True, slots=True)
class Forecast:
    """Predicted places in the route frame of the perception; n pedestrians in its order, K times."""

    times: FloatArray
    """From now, ascending, shape (K,) [s]."""
    along: FloatArray
    """Shape (n, K) [m]."""
    across: FloatArray
    """Shape (n, K) [m]."""
    reach: FloatArray
    """How far from that place the pedestrian may be, shape (n, K); zero for a single prediction [m]."""


class Predictor(Protocol):
    """Predicts the pedestrians of one ego; it may remember, so: one per ego."""

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return where everybody in the perception will be at those times from now [s]."""
        ...
