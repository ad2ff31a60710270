"""The smallest boxes along the lane that contain the bodies of vehicles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.remembered import remembered
from controllers.interface import Vehicles

ALONG_THE_LANE = np.deg2rad(60.0)
"""Vehicles whose heading differs by less drive along the ego's lane; others cross or are oncoming [rad]."""
ONCOMING = np.deg2rad(150.0)
"""Vehicles whose heading differs by more than this from that of the lane come towards the ego [rad]."""


class Footprints(NamedTuple):
    """Extents of vehicles in the route frame, arrays of length n."""

    rear: FloatArray
    front: FloatArray
    right: FloatArray
    left: FloatArray
    same_way: NDArray[np.bool_]
    oncoming: NDArray[np.bool_]

    def close_ahead_of(self, i: int, within: float, overlap: float) -> NDArray[np.bool_]:
        """Return which vehicles are in the way of the ``i``-th, close ahead of it, shape (n,).

        Parameters
        ----------
        i
            Row of the vehicle.
        within, overlap
            How far their rear ends may be ahead of its front, and behind it [m].
        """
        front = self.front[i]
        close = (self.rear > front - overlap) & (self.rear < front + within)
        return np.asarray(close & (self.right < self.left[i]) & (self.left > self.right[i]))


@remembered
def footprints(vehicles: Vehicles) -> Footprints:
    """Return the smallest boxes along the lane that contain the bodies."""
    cos, sin = np.cos(vehicles.heading_error), np.sin(vehicles.heading_error)
    centre = vehicles.along - 0.5 * vehicles.length * cos
    half_along = 0.5 * (vehicles.length * np.abs(cos) + vehicles.width * np.abs(sin))
    half_across = 0.5 * (vehicles.length * np.abs(sin) + vehicles.width * np.abs(cos))
    return Footprints(
        centre - half_along,
        centre + half_along,
        vehicles.across - half_across,
        vehicles.across + half_across,
        np.abs(vehicles.heading_error) < ALONG_THE_LANE,
        np.abs(vehicles.heading_error) > ONCOMING,
    )
