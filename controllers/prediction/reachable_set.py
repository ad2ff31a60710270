"""All places that pedestrians can reach with bounded acceleration, in any direction, and bounded pace."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Perception
from controllers.prediction.forecast import Forecast, Predictor


class ReachableSet:
    """Predicts a disc that contains every place that a pedestrian can reach.

    Two discs contain all these places. Whatever the pace, an acceleration of at most ``A`` leads no further
    than ``A t² / 2`` from ``p + v t``. Pedestrians who have accelerated for ``τ = V / A`` go on with a pace
    of at most ``V``: no further than ``A τ² / 2 + V (t − τ)`` from ``p + v τ``. The forecast is the smallest
    disc around the intersection of both.

    Parameters
    ----------
    acceleration : A [m/s^2]
    pace : V; for pedestrians who are already faster, their present pace is the bound [m/s]
    """

    def __init__(self, acceleration: float, pace: float) -> None:
        self._acceleration = acceleration
        self._pace = pace

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return the middles of the discs; ``reach`` is their radius."""
        people = perception.pedestrians
        velocity = np.stack((people.along_speed, people.across_speed))[:, :, None]
        place = np.stack((people.along, people.across))[:, :, None]
        pace = np.hypot(*velocity)
        turned, radius = self._common(pace, np.broadcast_to(times, (len(people), len(times))))
        middle = place + velocity * turned
        return Forecast(times, middle[0], middle[1], radius)

    def _common(self, pace: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the smallest disc around the intersection of both discs.

        Parameters
        ----------
        pace : present pace, shape (n, 1) [m/s]
        times : shape (n, K) [s]

        Returns
        -------
        after : time after which pedestrians who keep their velocity would be at its middle [s]
        radius : [m]
        """
        bound = self._acceleration
        fastest = np.maximum(self._pace, pace)
        until = np.minimum(fastest / bound, times)
        wide = 0.5 * bound * times**2
        slow = 0.5 * bound * until**2 + fastest * (times - until)
        apart = pace * (times - until)
        safe = np.where(apart > 1e-9, apart, 1.0)
        # From the middle of the first disc back to the chord in which the two circles meet.
        back = np.where(apart > 1e-9, (apart**2 + wide**2 - slow**2) / (2.0 * safe), 0.0)
        lens = (apart > 1e-9) & (back > 0.0) & (back < apart)
        half_chord = np.sqrt(np.maximum(wide**2 - back**2, 0.0))
        per_pace = back / np.maximum(pace, 1e-9)
        after = np.where(lens, times - per_pace, np.where(slow < wide, until, times))
        return after, np.where(lens, half_chord, np.minimum(slow, wide))


def build(*, acceleration: float = 1.5, pace: float = 2.5) -> Predictor:
    """Build the predictor.

    Parameters
    ----------
    acceleration : greatest acceleration, in any direction [m/s^2]
    pace : greatest pace [m/s]

    Raises
    ------
    ValueError
        If one is not above 0 and finite.
    """
    for name, value in {"acceleration": acceleration, "pace": pace}.items():
        if not 0.0 < value < float("inf"):
            raise ValueError(f"{name} = {value} must be above 0 and finite")
    return ReachableSet(acceleration, pace)
