"""Vehicles that stand where lanes merge, and wait for the ego.

SUMO's drivers let the vehicle go first that is closer to a merge, by distances that SUMO computes itself. If
the ego takes such a waiting vehicle for its leader, it waits too, and neither ever moves.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import BoolArray
from controllers.driving.standing import StoodSince, standing
from controllers.geometry.footprints import Footprints, footprints
from controllers.interface import Perception

PATIENCE, LONG_PATIENCE = 5.0, 15.0
"""A vehicle that has stood for this long is taken to wait for the ego: the first value applies if nothing
ahead of it explains why it stands, the second if something does, as that may wait for the ego itself [s]."""
ROOM = 5.0
"""Vehicles, people and stop lines within this distance ahead may be why a vehicle stands [m]."""
OVERLAP = 0.5
"""Those vehicles and people may also be this far behind its front [m]."""
ASIDE = 1.0
"""People up to this far beside the way of the vehicle may be why it stands [m]."""
IN_THE_LANE = 0.8
"""Vehicles whose middle is nearer than this to that of the ego's lane stand in a queue in it [m]."""


@dataclass(slots=True)
class WaitingForTheEgo:
    """Watches the vehicles that stand near one ego."""

    _standing: StoodSince = field(default_factory=StoodSince)

    def look(self, perception: Perception) -> BoolArray:
        """Return which vehicles ahead have stood so long that they wait for the ego, shape (n,)."""
        vehicles, time = perception.vehicles, perception.ego.time
        box, waits = footprints(vehicles), np.zeros(len(vehicles), dtype=np.bool_)
        ahead = (standing(vehicles) & box.same_way & (box.front > 0.0)).nonzero()[0].tolist()
        self._standing.look((vehicles.names[i] for i in ahead), time)
        for i in ahead:
            stood = self._standing.stood(vehicles.names[i], time)
            if stood >= PATIENCE:
                waits[i] = stood >= LONG_PATIENCE or not _explained(perception, box, i)
        return waits


def in_queue(perception: Perception, centre: float) -> BoolArray:
    """Return which vehicles are in the middle of a lane, so that a driver in it queues with them, shape (n,).

    Parameters
    ----------
    perception : what the ego is told
    centre : across coordinate of the lane's centre line, wherever in the lane the ego wants to drive [m]
    """
    return np.asarray(np.abs(perception.vehicles.across - centre) <= IN_THE_LANE)


def _explained(perception: Perception, box: Footprints, i: int) -> bool:
    """Return whether something close ahead of a vehicle may be why it stands."""
    road, people, front = perception.road, perception.pedestrians, box.front[i]
    lines = [signal.stop_line for signal in road.signals] + [sign.stop_line for sign in road.stop_signs]
    if any(-1.0 < line - front < ROOM for line in lines):
        return True
    near = (people.along > front - OVERLAP) & (people.along < front + ROOM)
    beside = (people.across < box.left[i] + ASIDE) & (people.across > box.right[i] - ASIDE)
    return bool(box.close_ahead_of(i, ROOM, OVERLAP).any() or (near & beside).any())
