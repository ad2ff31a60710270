"""Other vehicles as bounds on the position: who is ahead in a band of the road."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Perception, Vehicles
from controllers.numerics import vehicles_ahead
from controllers.numerics.vehicles_ahead import Footprints as Footprints

FloatArray = NDArray[np.float64]


def footprints(vehicles: Vehicles) -> Footprints:
    """Return the smallest boxes along the lane that hold the bodies."""
    return vehicles_ahead.footprints(_arrays(vehicles))


class Blockade(NamedTuple):
    """The rear ends ahead, as bounds for a front bumper, shape (N,); inf where nobody is."""

    rear: FloatArray
    """Predicted rear bumper of the nearest vehicle in the way [m]."""
    rest: FloatArray
    """Where that rear bumper comes to rest should the vehicle brake hard from there [m]."""
    follow: FloatArray
    """As ``rear``, of those who are about to move into the way too: to keep a time gap to [m]."""
    name: str
    """Nearest vehicle now; empty for none."""


def blockade(perception: Perception, band: tuple[float, float], times: FloatArray) -> Blockade:
    """Return what vehicles ahead, in the band or about to be in it, leave free.

    A vehicle that brakes is expected to go on braking for 2 s, one that speeds up to go on for 1 s; one that
    moves across the road to stop in the middle of the next lane.

    Parameters
    ----------
    perception
        What the ego is told.
    band
        Right and left end of what the ego's body will sweep (across) [m].
    times
        Horizon, shape (N,) [s].
    """
    vehicles = perception.vehicles
    if len(vehicles) == 0:
        free = np.full(len(times), np.inf)
        return Blockade(free, free, free, "")
    centres = np.array([lane.offset for lane in perception.road.lanes])
    rear, rest, follow, nearest = vehicles_ahead.blockade(
        _arrays(vehicles), perception.ego.body.front, centres, band[0], band[1], times
    )
    return Blockade(rear, rest, follow, vehicles.names[nearest] if nearest >= 0 else "")


def _arrays(vehicles: Vehicles) -> vehicles_ahead.Vehicles:
    v = vehicles
    return vehicles_ahead.Vehicles(
        v.along, v.across, v.along_speed, v.across_speed, v.acceleration, v.heading_error, v.length, v.width
    )
