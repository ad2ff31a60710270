"""Vehicles as rectangles, where they are and where they will be if they drive straight on."""

from __future__ import annotations

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.geometry.box_clearances import Boxes
from controllers.geometry.plane import vehicles_in_plane
from controllers.interface import Perception

NONE = Boxes(*np.empty((5, 0)))
"""No vehicle."""
NOW = np.zeros(1)
"""The present instant [s]."""


def boxes_straight_on(perception: Perception, who: BoolArray, times: FloatArray = NOW) -> Boxes:
    """Return m vehicles at K instants if they drive straight on: K * m boxes, in the plane of ``to_plane``.

    Parameters
    ----------
    perception : what the ego is told
    who : which vehicles, shape (n,)
    times : the instants, shape (K,) [s]
    """
    them = perception.vehicles
    if not who.any():
        return NONE
    fronts, headings = vehicles_in_plane(perception.ego, perception.road, them)
    heading, length, width = headings[who], them.length[who], them.width[who]
    speed = np.hypot(them.along_speed[who], them.across_speed[who])
    ahead = np.outer(times, speed) - 0.5 * length
    x, y = fronts[who, 0] + ahead * np.cos(heading), fronts[who, 1] + ahead * np.sin(heading)
    return Boxes(x.ravel(), y.ravel(), *(np.tile(values, len(times)) for values in (heading, length, width)))
