"""Other vehicles as bounds on the position: who is ahead in a band of the road."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Perception, Vehicles

FloatArray = NDArray[np.float64]

ALONG_THE_LANE = np.deg2rad(60.0)
"""Vehicles whose heading differs by less drive along the ego's lane; others cross it or come towards it."""


@dataclass(frozen=True, slots=True)
class Footprints:
    """Extents of vehicles in the route frame, arrays of length n."""

    rear: FloatArray
    front: FloatArray
    right: FloatArray
    left: FloatArray
    same_way: NDArray[np.bool_]


def footprints(vehicles: Vehicles) -> Footprints:
    """Return the smallest boxes along the lane that hold the bodies."""
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
    )


@dataclass(frozen=True, slots=True)
class Blockade:
    """The rear ends ahead, as bounds for a front bumper, shape (N,); inf where nobody is."""

    rear: FloatArray
    """Predicted rear bumper of the nearest vehicle [m]."""
    rest: FloatArray
    """Where that rear bumper comes to rest should the vehicle brake hard from there [m]."""
    name: str
    """Nearest vehicle now; empty for none."""
    speed: float
    """Its speed; inf for none [m/s]."""


def blockade(
    perception: Perception,
    band: tuple[float, float],
    times: FloatArray,
    hard_braking: float = 8.0,
    merge_time: float = 2.0,
) -> Blockade:
    """Return what vehicles ahead, in the band or about to be in it, leave free.

    A vehicle that brakes is expected to go on braking for 2 s, one that speeds up to go on for 1 s.

    Parameters
    ----------
    perception
        What the ego is told.
    band
        Right and left end of what the ego's body will sweep (across) [m].
    times
        Horizon, shape (N,) [s].
    hard_braking
        Assumed of the vehicle ahead for ``rest`` [m/s^2].
    merge_time
        A vehicle that will be in the band within this time counts already [s].
    """
    vehicles = perception.vehicles
    nobody = Blockade(np.full(len(times), np.inf), np.full(len(times), np.inf), "", float("inf"))
    if len(vehicles) == 0:
        return nobody
    box = footprints(vehicles)
    drift = np.where(np.abs(vehicles.across_speed) > 0.15, vehicles.across_speed * merge_time, 0.0)
    right = box.right + np.minimum(drift, 0.0)
    left = box.left + np.maximum(drift, 0.0)
    # Crossing and oncoming vehicles count only where they are: what they will do is the duty to yield's.
    right = np.where(box.same_way, right, box.right)
    left = np.where(box.same_way, left, box.left)
    inside = (right < band[1]) & (left > band[0])
    ego_front = perception.ego.body.front
    ahead = inside & (0.5 * (box.rear + box.front) > 0.5 * ego_front)
    # Somebody beside the ego who drifts towards it is not ahead; braking for the rear end would be late.
    ahead &= (box.rear > ego_front - 1.0) | ((box.right < band[1] - 0.2) & (box.left > band[0] + 0.2))
    if not ahead.any():
        return nobody
    chosen = np.flatnonzero(ahead)
    speed = np.where(box.same_way, np.maximum(vehicles.along_speed, 0.0), 0.0)[chosen]
    braking = np.clip(-vehicles.acceleration[chosen], 0.0, 6.0)
    braking = np.where(braking > 0.3, braking, 0.0)
    brake_time = np.minimum(
        np.minimum(times[None, :], 2.0),
        np.where(braking > 0, speed / np.maximum(braking, 1e-9), 0.0)[:, None],
    )
    gain = np.where(box.same_way[chosen], np.clip(vehicles.acceleration[chosen], 0.0, 1.5), 0.0)
    push = np.minimum(times, 1.0)[None, :]
    later_speed = speed[:, None] - braking[:, None] * brake_time + gain[:, None] * push
    rear = (
        box.rear[chosen][:, None]
        + speed[:, None] * brake_time
        - 0.5 * braking[:, None] * brake_time**2
        + (speed[:, None] - braking[:, None] * brake_time) * (times[None, :] - brake_time)
        + gain[:, None] * push * (times[None, :] - 0.5 * push)
    )
    rest = rear + later_speed**2 / (2.0 * hard_braking)
    nearest = chosen[np.argmin(box.rear[chosen])]
    return Blockade(
        rear.min(axis=0),
        rest.min(axis=0),
        vehicles.names[nearest],
        float(speed[np.argmin(box.rear[chosen])]),
    )
