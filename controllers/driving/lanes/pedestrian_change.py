"""Whether a change of lane may begin near a crossing because of the pedestrians on it.

In all other cases, no change that the route does not require begins near a crossing: the ego might pass a
vehicle that has stopped for a pedestrian and hides them.
"""

from __future__ import annotations

import numpy as np

from controllers.interface import Crossing, Perception

STRAIGHT_BEFORE = 2.0
"""The change has to end at least this far before the crossing [m]."""
FREE_BEYOND = 15.0
"""No vehicle may be in either lane up to this far beyond the crossing [m]."""
BESIDE = 0.3
"""A vehicle that juts into a lane by less than this is not in it [m]."""


def open_for_pedestrians(perception: Perception, number: int, length: float) -> bool:
    """Return whether a change to an adjacent lane may begin because of people at the next crossing.

    It may if pedestrians are on the crossing or about to step onto it, the change ends before it, and no
    vehicle is in either lane up to a distance beyond it: the way through is free, and nobody is hidden.

    Parameters
    ----------
    perception : what the ego knows
    number : ``Lane.number`` of the other lane
    length : distance that the change takes [m]
    """
    crossing, index = _next_crossing(perception)
    if crossing is None or crossing.entry - perception.ego.body.front < length + STRAIGHT_BEFORE:
        return False
    people = perception.pedestrians
    if not ((people.crossing == index) & (people.on_crossing | people.waiting)).any():
        return False
    return not _vehicles_up_to(perception, number, crossing.exit + FREE_BEYOND)


def _next_crossing(perception: Perception) -> tuple[Crossing | None, int]:
    """Return the nearest crossing that the ego has not passed, and its index."""
    ahead = [
        (crossing.entry, index)
        for index, crossing in enumerate(perception.road.crossings)
        if crossing.exit > -perception.ego.body.rear_overhang
    ]
    if not ahead:
        return None, -1
    index = min(ahead)[1]
    return perception.road.crossings[index], index


def _vehicles_up_to(perception: Perception, number: int, distance: float) -> bool:
    """Return whether a vehicle is ahead in the reference lane or the given one, up to a distance [m]."""
    vehicles, road = perception.vehicles, perception.road
    ahead = (vehicles.along > 0.0) & (vehicles.along - vehicles.length < distance)
    half = 0.5 * (
        vehicles.width * np.abs(np.cos(vehicles.heading_error))
        + vehicles.length * np.abs(np.sin(vehicles.heading_error))
    )
    for lane in (road.lane(road.reference), road.lane(number)):
        if lane is not None:
            inside = np.abs(vehicles.across - lane.offset) - half < 0.5 * lane.width - BESIDE
            if (ahead & inside).any():
                return True
    return False
