"""Lanes blocked by a vehicle that will not drive on: parked, broken down, or at roadworks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.standing import StoodSince, standing
from controllers.geometry.footprints import Footprints, footprints
from controllers.interface import Lane, Perception, RoadAhead

CREEPING = 2.0
"""Vehicles slower than this move up in a queue, or have just set off in it [m/s]."""
OVERLAP = 1.0
"""In a bend, the boxes of two vehicles in a queue may overlap by this [m]."""


@dataclass(slots=True)
class BlockedLanes:
    """Watches standing vehicles; one per ego.

    A vehicle that has stood for ``patience`` with no crossing, signal, stop sign or duty to yield close ahead
    of it, nor in a queue behind one that waits there, is not waiting for anything. Its lane then appears to
    end ``distance`` before it, so that methods that leave a lane before its end also go round a parked
    vehicle, or stop where they still can steer out. A vehicle that stands across the lane, or faces the ego,
    may be waiting for the ego and does not count. Nor does one in a junction whose traffic light is still
    ahead of the ego. The ego's lane does not appear to end if the lanes beside it lead off the route before
    the ego could come back: they are no way past.

    Parameters
    ----------
    patience
        Time after which a vehicle that stands for no reason counts as parked [s].
    reason
        A crossing or stop line within this distance ahead of a vehicle explains why it stands [m].
    queue
        A vehicle that waits, within this distance ahead in the same lane, explains it too [m].
    distance
        Room to steer out behind the vehicle [m].
    past
        Length of a lane beyond the vehicle that it takes to come back from it [m].
    """

    patience: float = 4.0
    reason: float = 40.0
    queue: float = 10.0
    distance: float = 9.0
    past: float = 15.0
    _standing: StoodSince = field(default_factory=StoodSince)
    _blocked: frozenset[int] = frozenset()

    def ends(self, lane: Lane) -> bool:
        """Return whether the lane ended at a vehicle in the perception that ``look`` returned last."""
        return lane.number in self._blocked

    def look(self, perception: Perception) -> Perception:
        """Return the perception with blocked lanes shortened so that they end before the vehicle."""
        self._blocked = frozenset()
        vehicles, time = perception.vehicles, perception.ego.time
        box = footprints(vehicles)
        ahead = box.same_way & (box.rear > 0.0)
        without_reason = ahead & standing(vehicles)
        if without_reason.any():
            without_reason &= ~self._waiting(perception, box, ahead)
        names = {vehicles.names[i]: i for i in without_reason.nonzero()[0].tolist()}
        self._standing.look(names, time)
        blocking = [i for name, i in names.items() if self._standing.stood(name, time) >= self.patience]
        if not blocking:
            return perception
        known, here = perception.road.lanes, perception.road.reference
        beside = [lane.follows_route_for for lane in known if lane.number != here]
        lanes = tuple(
            self._shortened(lane, box, blocking, beside if lane.number == here else ()) for lane in known
        )
        self._blocked = frozenset(new.number for old, new in zip(known, lanes, strict=True) if new is not old)
        return replace(perception, road=replace(perception.road, lanes=lanes))

    def _waiting(self, perception: Perception, box: Footprints, ahead: BoolArray) -> BoolArray:
        """Return which vehicles ahead wait for something, or in a queue behind others that do, shape (n,)."""
        vehicles = perception.vehicles
        slow = ahead & (np.hypot(vehicles.along_speed, vehicles.across_speed) < CREEPING)
        waits = slow & self._have_reason(perception.road, box.front)
        others = (slow & ~waits).nonzero()[0]
        for i in others[np.argsort(-box.front[others], kind="stable")].tolist():  # from the head of a queue
            waits[i] = (waits & box.close_ahead_of(i, self.queue, OVERLAP)).any()
        return waits

    def _have_reason(self, road: RoadAhead, front: FloatArray) -> BoolArray:
        """Return where something close ahead on the road explains why a vehicle stands, shape (n,)."""
        places = [crossing.entry for crossing in road.crossings]
        places += [sign.stop_line for sign in road.stop_signs]
        places += [foe.stop_line for foe in road.foes]
        lights = np.array([signal.stop_line for signal in road.signals]) - front[:, None]
        gap = np.array(places) - front[:, None]
        near = (np.abs(lights) < self.reason).any(axis=1) | ((gap > -3.0) & (gap < self.reason)).any(axis=1)
        return np.asarray(near)

    def _shortened(self, lane: Lane, box: Footprints, blocking: list[int], beside: Sequence[float]) -> Lane:
        """Return a lane that ends before the first of some vehicles in it, if there is any.

        Parameters
        ----------
        lane : the lane
        box, blocking : all vehicles, and the rows of those that will not drive on
        beside : how far the lanes beside follow the route, if they have to lead past the vehicles [m]
        """
        right, left = lane.offset - 0.5 * lane.width, lane.offset + 0.5 * lane.width
        first = min(
            (i for i in blocking if box.right[i] < left - 0.3 and box.left[i] > right + 0.3),
            key=lambda i: float(box.rear[i]),
            default=None,
        )
        if first is None or (beside and max(beside) < box.front[first] + self.past):
            return lane
        end = float(box.rear[first]) - self.distance
        return replace(lane, follows_route_for=end) if end < lane.follows_route_for else lane
