"""Other vehicles as bounds on the position: who is ahead in a band of the road, and where they will be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.arrays import BoolArray, FloatArray, IntArray
from controllers.geometry.footprints import Footprints, footprints
from controllers.geometry.swing import swung_out
from controllers.interface import Perception, Vehicles

HARD_BRAKING = 8.0
"""Assumed of a vehicle ahead for ``rest`` [m/s^2]."""
IN_THE_WAY_WITHIN = 0.5
"""A vehicle that drifts into the band within this time is in the way already [s]."""
MERGING_WITHIN = 2.0
"""One that will be in the band within this time is about to [s]."""
DRIFTING = 0.15
"""Slower movement across the road is not taken for a change of lane [m/s]."""
TURNING_SPEED, ROOM_TO_TURN = 2.0, 4.0
"""A slower vehicle that does not go the ego's way manoeuvres, and is left so much more room [m/s, m]."""


class Blockade(NamedTuple):
    """The rear ends ahead, as bounds for a front bumper, shape (N,); inf where nobody is."""

    rear: FloatArray
    """Predicted rear bumper of the nearest vehicle in the way [m]."""
    rest: FloatArray
    """Where that rear bumper comes to rest should the vehicle brake hard from there [m]."""
    follow: FloatArray
    """As ``rear``, of those who are about to move into the way too, and nearer for those who stand across
    the ego's lane or come towards it and may need room to get out of it: to keep a time gap to [m]."""
    name: str
    """Nearest vehicle now; empty for none."""

    @property
    def pace(self) -> FloatArray:
        """Predicted speed of the nearest vehicle in the way; 0 where nobody is [m/s]."""
        braking_distance = np.zeros(len(self.rear))
        np.subtract(self.rest, self.rear, out=braking_distance, where=np.isfinite(self.rear))
        return np.asarray(np.sqrt(2.0 * HARD_BRAKING * np.maximum(braking_distance, 0.0)))


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
    front = perception.ego.body.front
    centres = np.array([lane.offset for lane in perception.road.lanes])
    box = footprints(vehicles)
    turning = ~box.same_way & (np.hypot(vehicles.along_speed, vehicles.across_speed) < TURNING_SPEED)
    right, left = _swung_out(perception, box, band, turning)
    soon, later = _ahead(vehicles, box, front, centres, right, left)
    chosen = (soon | later).nonzero()[0]
    if len(chosen) == 0:
        free = np.full(len(times), np.inf)
        return Blockade(free, free, free, "")
    rear, speed = _predicted(vehicles, box, chosen, times)
    rest = rear + speed**2 / (2.0 * HARD_BRAKING)
    blocking = soon[chosen].nonzero()[0]
    nearest = int(chosen[np.argmin(box.rear[chosen])])
    nobody = np.inf
    in_lane = (box.right < band[1]) & (box.left > band[0])  # those beside it need none to get out of it
    room = np.where((turning & in_lane)[chosen], ROOM_TO_TURN, 0.0).reshape(-1, 1)
    return Blockade(
        rear[blocking].min(axis=0, initial=nobody),
        rest[blocking].min(axis=0, initial=nobody),
        (rear - room).min(axis=0, initial=nobody),
        vehicles.names[nearest],
    )


def _swung_out(
    perception: Perception, box: Footprints, band: tuple[float, float], who: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return the band at the place of each vehicle, for some as wide as the front swings out in a bend.

    Parameters
    ----------
    perception : the ego's body and the bends of its road
    box : vehicles
    band : right and left end where the road is straight [m]
    who : the vehicles for which it is widened, shape (n,)
    """
    right, left = np.full(len(who), band[0]), np.full(len(who), band[1])
    body, road = perception.ego.body, perception.road
    if not who.any() or not len(road.curvature):
        return right, left
    front, out = body.front, swung_out(body, road.curvature)
    axle = np.arange(len(out)) * road.curvature_step
    for i in np.flatnonzero(who):
        # Where the rear axle is while the front bumper is beside the vehicle.
        beside = (axle > box.rear[i] - front - road.curvature_step) & (axle < box.front[i] - front)
        right[i] -= out[beside & (road.curvature > 0.0)].max(initial=0.0)
        left[i] += out[beside & (road.curvature < 0.0)].max(initial=0.0)
    return right, left


def _ahead(
    vehicles: Vehicles,
    box: Footprints,
    front: float,
    centres: FloatArray,
    right: FloatArray,
    left: FloatArray,
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
    return possible & _drifts_in(box, first, right, left), possible & _drifts_in(box, second, right, left)


def _drifts_in(box: Footprints, drift: FloatArray, right: FloatArray, left: FloatArray) -> BoolArray:
    """Return who is in a band somewhere on the way across, signed."""
    return (box.right + np.minimum(drift, 0.0) < left) & (box.left + np.maximum(drift, 0.0) > right)


def _predicted(
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
