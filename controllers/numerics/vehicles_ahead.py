"""Who is ahead in a band of the road, and where they will be; see ``driving.vehicles_ahead``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

ALONG_THE_LANE = np.deg2rad(60.0)
"""Vehicles whose heading differs by less drive along the ego's lane; others cross it or come towards it."""
HARD_BRAKING = 8.0
"""Assumed of a vehicle ahead for ``rest`` [m/s^2]."""
IN_THE_WAY_WITHIN = 0.5
"""A vehicle that drifts into the band within this time is in the way already [s]."""
MERGING_WITHIN = 2.0
"""One that will be in the band within this time is about to [s]."""
DRIFTING = 0.15
"""Slower movement across the road is not taken for a change of lane [m/s]."""


class Vehicles(NamedTuple):
    """Vehicles in the route frame as ``controllers.interface.Vehicles`` has them, arrays of length n."""

    along: FloatArray
    across: FloatArray
    along_speed: FloatArray
    across_speed: FloatArray
    acceleration: FloatArray
    heading_error: FloatArray
    length: FloatArray
    width: FloatArray


class Footprints(NamedTuple):
    """Extents of vehicles in the route frame, arrays of length n."""

    rear: FloatArray
    front: FloatArray
    right: FloatArray
    left: FloatArray
    same_way: BoolArray


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


def blockade(
    vehicles: Vehicles, front: float, centres: FloatArray, right: float, left: float, times: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, int]:
    """Return what vehicles ahead leave free of a band, and who is nearest.

    Parameters
    ----------
    vehicles : all of them
    front : of the ego, from its rear axle [m]
    centres : of the lanes, across [m]
    right, left : ends of the band, across [m]
    times : horizon, shape (N,) [s]

    Returns
    -------
    Rear bumper of those in the way, where it comes to rest, rear bumper of those about to be in the way too,
    shape (N,) each, inf for nobody [m]; index of the nearest, -1 for nobody.
    """
    box = footprints(vehicles)
    soon, later = ahead(vehicles, box, front, centres, right, left)
    chosen = np.flatnonzero(soon | later)
    if len(chosen) == 0:
        free = np.full(len(times), np.inf)
        return free, free, free, -1
    rear, speed = predicted(vehicles, box, chosen, times)
    rest = rear + speed**2 / (2.0 * HARD_BRAKING)
    blocking = np.flatnonzero(soon[chosen])
    nearest = int(chosen[np.argmin(box.rear[chosen])])
    nobody = np.inf
    return (
        rear[blocking].min(axis=0, initial=nobody),
        rest[blocking].min(axis=0, initial=nobody),
        rear.min(axis=0, initial=nobody),
        nearest,
    )


def ahead(
    vehicles: Vehicles, box: Footprints, front: float, centres: FloatArray, right: float, left: float
) -> tuple[BoolArray, BoolArray]:
    """Return who is ahead of the ego and in the band, now or soon, and who now or a little later."""
    middle_ahead = 0.5 * (box.rear + box.front) > 0.5 * front
    # Somebody beside the ego who drifts towards it is not ahead; braking for the rear end would be late.
    in_band = (box.right < left - 0.2) & (box.left > right + 0.2)
    possible = middle_ahead & ((box.rear > front - 1.0) | in_band)
    # Crossing and oncoming vehicles count only where they are: what they will do is the duty to yield's.
    drifting = possible & box.same_way & (np.abs(vehicles.across_speed) > DRIFTING)
    if not drifting.any():
        there = possible & (box.right < left) & (box.left > right)
        return there, there
    side = np.where(drifting, np.sign(vehicles.across_speed), 0.0)
    towards = np.full(len(side), np.inf)
    for centre in centres:
        way = centre - vehicles.across
        towards = np.where(way * side > 0.1, np.minimum(towards, np.abs(way)), towards)
    first = side * np.minimum(np.abs(vehicles.across_speed) * IN_THE_WAY_WITHIN, towards)
    second = side * np.minimum(np.abs(vehicles.across_speed) * MERGING_WITHIN, towards)
    return possible & drifts_in(box, first, right, left), possible & drifts_in(box, second, right, left)


def drifts_in(box: Footprints, drift: FloatArray, right: float, left: float) -> BoolArray:
    """Return who is in a band somewhere on the way across, signed."""
    return (box.right + np.minimum(drift, 0.0) < left) & (box.left + np.maximum(drift, 0.0) > right)


def predicted(
    vehicles: Vehicles, box: Footprints, chosen: IntArray, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return rear bumpers and speeds over the horizon, shape (len(chosen), N) each."""
    same_way = box.same_way[chosen]
    speed = np.where(same_way, np.maximum(vehicles.along_speed[chosen], 0.0), 0.0).reshape(-1, 1)
    change = vehicles.acceleration[chosen]
    braking = np.where(change < -0.3, np.minimum(-change, 6.0), 0.0).reshape(-1, 1)
    gain = np.where(same_way, np.minimum(np.maximum(change, 0.0), 1.5), 0.0).reshape(-1, 1)
    stopping = np.where(braking > 0.0, speed / np.maximum(braking, 1e-9), 0.0)
    brake_time = np.minimum(np.minimum(times, 2.0), stopping)
    push = np.minimum(times, 1.0)
    slowed = speed - braking * brake_time
    rear = (
        box.rear[chosen].reshape(-1, 1)
        + speed * brake_time
        - 0.5 * braking * brake_time**2
        + slowed * (times - brake_time)
        + gain * push * (times - 0.5 * push)
    )
    return rear, slowed + gain * push
