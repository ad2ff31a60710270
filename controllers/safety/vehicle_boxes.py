"""Vehicles near the ego, as rectangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.box_clearances import Boxes
from controllers.geometry.boxes_of_vehicles import NONE, boxes_straight_on
from controllers.geometry.footprints import footprints
from controllers.geometry.plane import to_plane
from controllers.interface import Perception

STANDING = 0.5
"""Below this speed, a vehicle counts as standing [m/s]."""
NEAR, NEAR_DRIVING = 15.0, 35.0
"""Vehicles of which every part is farther than this from the ego's middle do not count. The second value is
for oncoming vehicles, for those outside a bend, and for those that drive wherever they will be, the first for
all others [m]."""
DRIVEN_FOR = np.linspace(0.0, 3.0, 7)
"""Instants at which driving vehicles are considered [s]."""


def standing_vehicles(perception: Perception) -> Boxes:
    """Return the standing vehicles, in the plane of :mod:`controllers.geometry.plane`."""
    return boxes_straight_on(perception, _near(perception, NEAR) & _stand(perception))


def driving_vehicles(perception: Perception) -> Boxes:
    """Return the driving vehicles wherever they will be in the next seconds: one box for each instant.

    Vehicles that follow the ego are left out.
    """
    them = perception.vehicles
    follow = footprints(them).same_way & (them.along < 0.0)
    who = _near(perception, NEAR_DRIVING) & ~_stand(perception) & ~follow
    return boxes_straight_on(perception, who, DRIVEN_FOR)


def crossing_vehicles(perception: Perception, times: FloatArray) -> Boxes:
    """Return the vehicles that drive across the ego's way or towards it, straight on, at K instants [s].

    Vehicles that drive the ego's way are left to car-following and do not count.
    """
    who = _near(perception, NEAR) & ~_stand(perception) & ~footprints(perception.vehicles).same_way
    return _straight_on(perception, who, times)


def beside_in_lane(perception: Perception, times: FloatArray) -> Boxes:
    """Return the vehicles that drive beside the ego in its own lane, straight on, at K instants [s].

    Cyclists do so in wide lanes. Which way they take at a junction is not known.
    """
    them, ego, road = perception.vehicles, perception.ego, perception.road
    box, lane = footprints(them), road.lane(road.reference)
    if lane is None:
        return NONE
    half = 0.5 * ego.body.width
    aside = (box.left < ego.across - half) | (box.right > ego.across + half)
    aside &= np.abs(them.across - lane.offset) < 0.5 * lane.width
    who = _near(perception, NEAR) & ~_stand(perception) & box.same_way & aside
    return _straight_on(perception, who, times)


def outside_the_bend(perception: Perception, times: FloatArray, side: float) -> Boxes:
    """Return the vehicles that drive past on the outer side of a bend, straight on, at K instants [s].

    Those in the ego's lane and those that come towards it do not count.

    Parameters
    ----------
    perception : what the ego is told
    times : the instants, shape (K,) [s]
    side : 1 if the outer side is the left one, -1 if it is the right one
    """
    them, lane = perception.vehicles, perception.road.lane(perception.road.reference)
    if lane is None:
        return NONE
    outside = side * (them.across - lane.offset) > 0.5 * lane.width
    who = _near(perception, NEAR_DRIVING) & ~_stand(perception) & outside & ~footprints(them).oncoming
    return _straight_on(perception, who, times)


def oncoming_vehicles(perception: Perception, times: FloatArray) -> Boxes:
    """Return the vehicles that come towards the ego along its road, at K instants [s].

    They are assumed to keep their lane, also in bends.
    """
    them = perception.vehicles
    towards = footprints(them).oncoming & (them.along > 0.0)
    who = _near(perception, NEAR_DRIVING) & ~_stand(perception) & towards
    count = int(who.sum())
    if not count:
        return NONE
    middle = them.along[who] + 0.5 * them.length[who]
    along = middle + np.outer(times, them.along_speed[who])
    across = np.broadcast_to(them.across[who], along.shape)
    places, heading = to_plane(perception.road, along.ravel(), across.ravel())
    shape = len(times), count
    return Boxes(
        places[:, 0].reshape(shape),
        places[:, 1].reshape(shape),
        heading.reshape(shape),
        them.length[who],
        them.width[who],
    )


def _near(perception: Perception, most: float) -> NDArray[np.bool_]:
    """Return which vehicles have a part near the ego: the tail of a lorry may be, though its front is not."""
    box, ego = footprints(perception.vehicles), perception.ego
    middle = 0.5 * ego.body.front
    ahead = np.maximum(np.maximum(box.rear - middle, middle - box.front), 0.0)
    aside = np.maximum(np.maximum(box.right - ego.across, ego.across - box.left), 0.0)
    return np.asarray(np.hypot(ahead, aside) < most)


def _stand(perception: Perception) -> NDArray[np.bool_]:
    them = perception.vehicles
    return np.asarray(np.hypot(them.along_speed, them.across_speed) < STANDING)


def _straight_on(perception: Perception, who: NDArray[np.bool_], times: FloatArray) -> Boxes:
    """Return m vehicles at each of K instants if they drive straight on: places of shape (K, m)."""
    boxes, shape = boxes_straight_on(perception, who, times), (len(times), int(who.sum()))
    if not shape[1]:
        return boxes
    sides = (values.reshape(shape)[0] for values in boxes[2:])
    return Boxes(boxes.x.reshape(shape), boxes.y.reshape(shape), *sides)
