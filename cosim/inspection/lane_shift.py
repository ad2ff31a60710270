"""Maps the lanes of a network, and positions on them, to those of the mended network.

A new sidewalk becomes lane 0 of its edge, so the numbers of the other lanes increase. If a junction grows,
the lanes that end at it become shorter.
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
"""Lanes farther apart than this are different lanes [m]."""
_CLASSES = ("passenger", "bus", "bicycle", "truck", "tram", "rail", "ship")
"""Classes whose permissions distinguish lanes; without pedestrians, whom a sidewalk takes off the others."""
_OTHERS_M = 100.0
"""Distance that is added if different classes may use two lanes [m]."""


class LaneShift:
    """Maps lanes and positions of a network to those of the same network with sidewalks and crossings.

    Parameters
    ----------
    before : the network for which the demand was written
    after : the mended network, with the same edges, which may have more lanes
    """

    def __init__(self, before: Network, after: Network) -> None:
        self.before = before
        self.after = after
        self._lanes = cache(self._matched)

    def lane(self, name: str) -> str | None:
        """Return the new name of a lane; ``None`` if there is no such lane."""
        old = self.before.lanes.get(name)
        return None if old is None else self._lanes(old.edge).get(name)

    def lane_on_foot(self, name: str) -> str | None:
        """Return the new lane for the pedestrians of a lane: the same lane, or the sidewalk of its edge."""
        new = self.lane(name)
        if new is None or self.after.lanes[new].permissions.allows(ON_FOOT):
            return new
        names = self.after.edges[self.after.lanes[new].edge]
        return next((one for one in names if self.after.lanes[one].permissions.allows(ON_FOOT)), None)

    def index(self, edge: str, index: int) -> int | None:
        """Return the new number of a lane of an edge; ``None`` if there is no such lane."""
        names = self.before.edges.get(edge, ())
        new = self.lane(names[index]) if 0 <= index < len(names) else None
        return None if new is None else self.after.lanes[new].index

    def place(self, old: str, new: str, position: float) -> float:
        """Return the position on a new lane that is nearest to a position on an old one [m].

        A negative position counts from the end of the lane; it is kept, but cut to the new lane's length.
        """
        source, target = self.before.lanes[old], self.after.lanes[new]
        if position < 0.0:
            return max(position, -target.length)
        if source.length == target.length and np.array_equal(source.shape, target.shape):
            return min(position, target.length)
        return min(_nearest(target, _point(source, position)), target.length)

    def place_on_edge(self, edge: str, position: float) -> float:
        """Return the new position for one on an edge; it is valid on all lanes of the edge [m]."""
        lanes = self.before.edges.get(edge, ())
        new = self.lane(lanes[0]) if lanes else None
        if new is None:
            return position
        place = self.place(lanes[0], new, position)
        shortest = min(self.after.lanes[name].length for name in self.after.edges[edge])
        return max(min(place, shortest), -shortest)

    def _matched(self, edge: str) -> dict[str, str]:
        """Return the new names of an edge's lanes: the most similar new lanes in the same order."""
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
    """Return how different two lanes are, as a distance [m]."""
    others = any(old.permissions.allows(one) != new.permissions.allows(one) for one in _CLASSES)
    return _distance(old, new) + _OTHERS_M * others


def _distance(old: NetLane, new: NetLane) -> float:
    """Return how far the middle of a lane is from another lane [m]."""
    x, y = _point(old, 0.5 * old.length)
    return distance_to_pieces(x, y, np.hstack([new.shape[:-1], new.shape[1:]]))


def _stations(lane: NetLane) -> NDArray[np.float64]:
    """Return SUMO's position at each point of the shape; a lane may be longer than it is drawn [m]."""
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
