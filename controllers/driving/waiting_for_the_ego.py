"""Vehicles that stand where ways merge, and wait for the ego.

SUMO's drivers let the vehicle go first that has come farther towards a merge, by distances of their own. An
ego that takes such a vehicle for one to follow waits for it, and neither ever moves.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import BoolArray
from controllers.driving.standing import StoodSince, standing
from controllers.geometry.footprints import Footprints, footprints
from controllers.interface import Lane, Perception

PATIENCE, LONG_PATIENCE = 5.0, 15.0
"""Whoever has stood for so long waits for the ego, without and with something ahead that may be why: those
who are ahead may wait for the ego themselves [s]."""
ROOM = 5.0
"""Vehicles, people and stop lines within this distance ahead may be why a vehicle stands [m]."""
ASIDE = 1.0
"""People count up to this far beside the way of the vehicle [m]."""
IN_THE_LANE = 0.8
"""Vehicles with their middle nearer than this to that of the ego's lane stand in a queue [m]."""


@dataclass(slots=True)
class WaitingForTheEgo:
    """Watches the vehicles that stand near one ego."""

    _standing: StoodSince = field(default_factory=StoodSince)

    def look(self, perception: Perception) -> BoolArray:
        """Return which vehicles have stood for so long, shape (n,)."""
        vehicles, time = perception.vehicles, perception.ego.time
        box, waits = footprints(vehicles), np.zeros(len(vehicles), dtype=np.bool_)
        ahead = (standing(vehicles) & box.same_way & (box.front > 0.0)).nonzero()[0].tolist()
        self._standing.look((vehicles.names[i] for i in ahead), time)
        for i in ahead:
            stood = self._standing.stood(vehicles.names[i], time)
            if stood >= PATIENCE:
                waits[i] = stood >= LONG_PATIENCE or not _explained(perception, box, i)
        return waits


def in_queue(perception: Perception, lane: Lane | None) -> BoolArray:
    """Return which vehicles are in a lane, so that whoever drives in it is behind or before them, shape (n,).

    Parameters
    ----------
    perception : what the ego is told
    lane : ``None`` for straight on
    """
    offset = lane.offset if lane is not None else 0.0
    return np.asarray(np.abs(perception.vehicles.across - offset) <= IN_THE_LANE)


def _explained(perception: Perception, box: Footprints, i: int) -> bool:
    """Return whether something close ahead of a vehicle may be why it stands."""
    road, people, front = perception.road, perception.pedestrians, box.front[i]
    lines = [signal.stop_line for signal in road.signals] + [sign.stop_line for sign in road.stop_signs]
    if any(-1.0 < line - front < ROOM for line in lines):
        return True
    before = (box.rear > front - 0.5) & (box.rear < front + ROOM)
    in_its_way = (box.right < box.left[i]) & (box.left > box.right[i])
    near = (people.along > front - 0.5) & (people.along < front + ROOM)
    beside = (people.across < box.left[i] + ASIDE) & (people.across > box.right[i] - ASIDE)
    return bool((before & in_its_way).any() or (near & beside).any())
