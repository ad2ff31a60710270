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
    """Predicted rear bumper of the nearest vehicle in the way [m]."""
    rest: FloatArray
    """Where that rear bumper comes to rest should the vehicle brake hard from there [m]."""
    follow: FloatArray
    """As ``rear``, of those who are about to move into the way too: to keep a time gap to [m]."""
    name: str
    """Nearest vehicle now; empty for none."""


HARD_BRAKING = 8.0
"""Assumed of a vehicle ahead for ``rest`` [m/s^2]."""
IN_THE_WAY_WITHIN = 0.5
"""A vehicle that drifts into the band within this time is in the way already [s]."""
MERGING_WITHIN = 2.0
"""One that will be in the band within this time is about to [s]."""
DRIFTING = 0.15
"""Slower movement across the road is not taken for a change of lane [m/s]."""


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
    free = np.full(len(times), np.inf)
    if len(vehicles) == 0:
        return Blockade(free, free, free, "")
    box = footprints(vehicles)
    soon, later = _ahead(perception, box, band, (IN_THE_WAY_WITHIN, MERGING_WITHIN))
    later |= soon
    if not later.any():
        return Blockade(free, free, free, "")
    chosen = np.flatnonzero(later)
    rear, speed = _predicted(vehicles, box, chosen, times)
    blocking = soon[chosen]
    nearest = chosen[np.argmin(box.rear[chosen])]
    rest = rear + speed**2 / (2.0 * HARD_BRAKING)
    return Blockade(
        rear[blocking].min(axis=0, initial=np.inf),
        rest[blocking].min(axis=0, initial=np.inf),
        rear.min(axis=0),
        vehicles.names[nearest],
    )


def _ahead(
    perception: Perception, box: Footprints, band: tuple[float, float], within: tuple[float, ...]
) -> list[NDArray[np.bool_]]:
    """Return who is ahead of the ego and in the band, now or within each of some times."""
    vehicles, front = perception.vehicles, perception.ego.body.front
    middle_ahead = 0.5 * (box.rear + box.front) > 0.5 * front
    # Somebody beside the ego who drifts towards it is not ahead; braking for the rear end would be late.
    in_band = (box.right < band[1] - 0.2) & (box.left > band[0] + 0.2)
    possible = middle_ahead & ((box.rear > front - 1.0) | in_band)
    # Crossing and oncoming vehicles count only where they are: what they will do is the duty to yield's.
    drifting = possible & box.same_way & (np.abs(vehicles.across_speed) > DRIFTING)
    if not drifting.any():
        there = possible & (box.right < band[1]) & (box.left > band[0])
        return [there.copy() for _ in within]
    side = np.where(drifting, np.sign(vehicles.across_speed), 0.0)
    centres = np.array([lane.offset for lane in perception.road.lanes])
    way = centres[None, :] - vehicles.across[:, None]
    towards = np.where(way * side[:, None] > 0.1, np.abs(way), np.inf).min(axis=1, initial=np.inf)
    found = []
    for time in within:
        drift = side * np.minimum(np.abs(vehicles.across_speed) * time, towards)
        right = box.right + np.minimum(drift, 0.0)
        left = box.left + np.maximum(drift, 0.0)
        found.append(possible & (right < band[1]) & (left > band[0]))
    return found


def _predicted(
    vehicles: Vehicles, box: Footprints, chosen: NDArray[np.int64], times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return rear bumpers and speeds over the horizon, shape (len(chosen), N) each."""
    same_way = box.same_way[chosen]
    speed = np.where(same_way, np.maximum(vehicles.along_speed[chosen], 0.0), 0.0)[:, None]
    change = vehicles.acceleration[chosen]
    braking = np.where(change < -0.3, np.minimum(-change, 6.0), 0.0)[:, None]
    gain = np.where(same_way, np.clip(change, 0.0, 1.5), 0.0)[:, None]
    stopping = np.where(braking > 0.0, speed / np.maximum(braking, 1e-9), 0.0)
    brake_time = np.minimum(np.minimum(times, 2.0), stopping)
    push = np.minimum(times, 1.0)
    slowed = speed - braking * brake_time
    rear = (
        box.rear[chosen][:, None]
        + speed * brake_time
        - 0.5 * braking * brake_time**2
        + slowed * (times - brake_time)
        + gain * push * (times - 0.5 * push)
    )
    return rear, slowed + gain * push
