"""Which lane of a mended network is which lane of the one before, and where a place on it is now.

A sidewalk becomes lane 0 of its edge, so the other lanes move up; and where a junction grows, the lanes that
end at it become shorter.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from analysis.polylines import arc_lengths
from cosim.inspection.roads import ON_FOOT
from cosim.sensing.lines_of_sight import distance_to_pieces
from cosim.sumo.network import NetLane, Network

FURTHEST_M = 2.5
"""A lane that is drawn further than this from the old one is another lane."""
_CLASSES = ("passenger", "bus", "bicycle", "truck", "tram", "rail", "ship")
"""Who tells lanes apart; people on foot do not, because a sidewalk takes them off the other lanes."""
_OTHERS_M = 100.0
"""What it counts if others may use a lane [m]."""


class LaneShift:
    """The way from a network to the same one with sidewalks and crossings.

    Parameters
    ----------
    before : the network that the demand was written for
    after : it has the same edges, which may have more lanes
    """

    def __init__(self, before: Network, after: Network) -> None:
        self.before = before
        self.after = after
        self._lanes = cache(self._matched)

    def lane(self, name: str) -> str | None:
        """Return what a lane is called now; ``None`` where there is no such lane."""
        old = self.before.lanes.get(name)
        return None if old is None else self._lanes(old.edge).get(name)

    def lane_on_foot(self, name: str) -> str | None:
        """Return the new lane of pedestrians of a lane: the same one, or the sidewalk of its edge."""
        new = self.lane(name)
        if new is None or self.after.lanes[new].permissions.allows(ON_FOOT):
            return new
        names = self.after.edges[self.after.lanes[new].edge]
        return next((one for one in names if self.after.lanes[one].permissions.allows(ON_FOOT)), None)

    def index(self, edge: str, index: int) -> int | None:
        """Return the number that a lane of an edge has now."""
        names = self.before.edges.get(edge, ())
        new = self.lane(names[index]) if 0 <= index < len(names) else None
        return None if new is None else self.after.lanes[new].index

    def place(self, old: str, new: str, position: float) -> float:
        """Return the position on a lane of now that is nearest to a place on a lane of before [m].

        A negative one counts from the lane's end, and still does: it is cut to the lane's length.
        """
        source, target = self.before.lanes[old], self.after.lanes[new]
        if position < 0.0:
            return max(position, -target.length)
        if source.length == target.length and np.array_equal(source.shape, target.shape):
            return min(position, target.length)
        return min(_nearest(target, _point(source, position)), target.length)

    def place_on_edge(self, edge: str, position: float) -> float:
        """Return the same for a place on an edge; its lanes are as long as each other."""
        lanes = self.before.edges.get(edge, ())
        new = self.lane(lanes[0]) if lanes else None
        if new is None:
            return position
        place = self.place(lanes[0], new, position)
        shortest = min(self.after.lanes[name].length for name in self.after.edges[edge])
        return max(min(place, shortest), -shortest)

    def _matched(self, edge: str) -> dict[str, str]:
        """Return the new names of an edge's lanes: the lanes in the same order that lie nearest."""
        old = [self.before.lanes[name] for name in self.before.edges[edge]]
        new = [self.after.lanes[name] for name in self.after.edges.get(edge, ())]
        if len(new) < len(old):
            return {}
        best = min(
            combinations(new, len(old)),
            key=lambda chosen: sum(map(_difference, old, chosen)),
        )
        return {
            one.name: other.name
            for one, other in zip(old, best, strict=True)
            if _distance(one, other) <= FURTHEST_M
        }


def _difference(old: NetLane, new: NetLane) -> float:
    """Return how unlike two lanes are [m]."""
    others = any(old.permissions.allows(one) != new.permissions.allows(one) for one in _CLASSES)
    return _distance(old, new) + _OTHERS_M * others


def _distance(old: NetLane, new: NetLane) -> float:
    """Return how far the middle of a lane is from another lane [m]."""
    x, y = _point(old, 0.5 * old.length)
    return distance_to_pieces(x, y, np.hstack([new.shape[:-1], new.shape[1:]]))


def _stations(lane: NetLane) -> NDArray[np.float64]:
    """Return SUMO's position at each point of the shape [m]; a lane may be longer than it is drawn."""
    drawn = arc_lengths(lane.shape)
    return drawn * (lane.length / max(float(drawn[-1]), 1e-9))


def _point(lane: NetLane, position: float) -> tuple[float, float]:
    stations = _stations(lane)
    x, y = (float(np.interp(position, stations, lane.shape[:, axis])) for axis in (0, 1))
    return x, y


def _nearest(lane: NetLane, point: tuple[float, float]) -> float:
    """Return the position on a lane that is nearest to a point [m]."""
    start, along = lane.shape[:-1], np.diff(lane.shape, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip(((np.array(point) - start) * along).sum(axis=1) / square, 0.0, 1.0)
    apart = np.hypot(*(start + share[:, None] * along - point).T)
    piece = int(apart.argmin())
    stations = _stations(lane)
    return float(stations[piece] + share[piece] * (stations[piece + 1] - stations[piece]))
