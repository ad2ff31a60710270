"""Other vehicles as bounds on the ego's position: which are ahead in a band of the road, and their motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.arrays import BoolArray, FloatArray, IntArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.standing import standing
from controllers.geometry.box_clearances import box_clearances
from controllers.geometry.boxes_of_vehicles import boxes_straight_on
from controllers.geometry.footprints import Footprints, footprints
from controllers.geometry.swing import swung_out
from controllers.interface import Perception, Vehicles

HARD_BRAKING = 8.0
"""Deceleration that a vehicle ahead is assumed to use in ``rest`` [m/s^2]."""
IN_THE_WAY_WITHIN = 0.5
"""A vehicle that drifts into the band within this time counts as in the way already [s]."""
MERGING_WITHIN = 2.0
"""A vehicle that drifts into the band within this time counts as about to move into the way [s]."""
DRIFTING = 0.15
"""Movement across the road below this speed does not count as a change of lane [m/s]."""
TURNING_SPEED, ROOM_TO_TURN = 2.0, 4.0
"""A vehicle below this speed that does not go the ego's way manoeuvres, and gets this much more room
[m/s, m]."""


class Blockade(NamedTuple):
    """The rear ends ahead, as bounds for the front bumper, shape (N,); inf where there is no vehicle."""

    rear: FloatArray
    """Predicted rear bumper of the nearest vehicle in the way [m]."""
    rest: FloatArray
    """Place where that rear bumper would come to rest if the vehicle braked hard from ``rear`` [m]."""
    follow: FloatArray
    """Place to keep a time gap to: like ``rear``, but including vehicles about to move into the way, and
    nearer for those who stand across the ego's lane or come towards it and may need room to leave it [m]."""
    name: str
    """Nearest vehicle now; empty for none."""

    @property
    def pace(self) -> FloatArray:
        """Predicted speed of the nearest vehicle in the way; 0 where there is none [m/s]."""
        braking_distance = np.zeros(len(self.rear))
        np.subtract(self.rest, self.rear, out=braking_distance, where=np.isfinite(self.rear))
        return np.asarray(np.sqrt(2.0 * HARD_BRAKING * np.maximum(braking_distance, 0.0)))


def blockade(perception: Perception, band: tuple[float, float], times: FloatArray) -> Blockade:
    """Return the bounds set by vehicles ahead that are in the band or about to be in it.

    A vehicle that brakes is expected to go on braking for 2 s, and one that speeds up to go on for 1 s. A
    vehicle that moves across the road is expected to stop in the middle of the next lane.

    Parameters
    ----------
    perception
        What the ego is told.
    band
        Right and left end of the band that the ego's body will sweep (across) [m].
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
    in_lane = (box.right < band[1]) & (box.left > band[0])
    swung_at = turning & standing(vehicles) & (soon | later) & ~in_lane
    if swung_at.any():
        passed = _passed(perception, band, swung_at)
        soon, later = soon & ~passed, later & ~passed
    chosen = (soon | later).nonzero()[0]
    if len(chosen) == 0:
        free = np.full(len(times), np.inf)
        return Blockade(free, free, free, "")
    rear, speed = _predicted(vehicles, box, chosen, times)
    rest = rear + speed**2 / (2.0 * HARD_BRAKING)
    blocking = soon[chosen].nonzero()[0]
    nearest = int(chosen[np.argmin(box.rear[chosen])])
    nobody = np.inf
    # Vehicles beside the lane need no room to leave it.
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
    """Return the band at the place of each vehicle, for some widened by how far the front swings out.

    Parameters
    ----------
    perception : gives the ego's body and the bends of its road
    box : footprints of the vehicles
    band : right and left end where the road is straight [m]
    who : vehicles for which the band is widened, shape (n,)
    """
    right, left = np.full(len(who), band[0]), np.full(len(who), band[1])
    body, road = perception.ego.body, perception.road
    if not who.any() or not len(road.curvature):
        return right, left
    front, out = body.front, swung_out(body, road.curvature)
    axle = np.arange(len(out)) * road.curvature_step
    for i in np.flatnonzero(who):
        # Places of the rear axle while the front bumper is beside the vehicle.
        beside = (axle > box.rear[i] - front - road.curvature_step) & (axle < box.front[i] - front)
        right[i] -= out[beside & (road.curvature > 0.0)].max(initial=0.0)
        left[i] += out[beside & (road.curvature < 0.0)].max(initial=0.0)
    return right, left


def _passed(perception: Perception, band: tuple[float, float], who: BoolArray) -> BoolArray:
    """Return which vehicles the true body passes at the distance that the band keeps, shape (n,).

    :func:`_swung_out` takes the front to be as far ahead along the road as it is from the rear axle. In a
    tight bend it is less far, so that a front that seems to swing into a vehicle may have left the bend by
    then.

    Parameters
    ----------
    perception, band : as for :func:`blockade`
    who : vehicles to be considered, shape (n,)
    """
    body = perception.ego.body
    farthest = float(footprints(perception.vehicles).front[who].max()) + body.rear_overhang
    _, way = way_into_lane.poses(perception, 0.5 * (band[0] + band[1]), farthest)
    x, y, heading = way[:, :, None]
    boxes = boxes_straight_on(perception, who)
    least = box_clearances(x, y, heading, body, boxes).min(axis=(0, 1))
    passed = np.zeros(len(who), dtype=np.bool_)
    passed[who] = least > 0.5 * (band[1] - band[0] - body.width)
    return passed


def _ahead(
    vehicles: Vehicles,
    box: Footprints,
    front: float,
    centres: FloatArray,
    right: FloatArray,
    left: FloatArray,
) -> tuple[BoolArray, BoolArray]:
    """Return which vehicles ahead are in the band now or soon, and which now or a little later."""
    middle_ahead = 0.5 * (box.rear + box.front) > 0.5 * front
    # A vehicle beside the ego that drifts towards it is not ahead: it is too late to brake for its rear end.
    in_band = (box.right < left - 0.2) & (box.left > right + 0.2)
    possible = middle_ahead & ((box.rear > front - 1.0) | in_band)
    # Crossing and oncoming vehicles count only where they are: the right of way deals with what they will do.
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
    """Return which vehicles are in a band somewhere on their drift across, left positive."""
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
