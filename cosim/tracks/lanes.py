"""Finds the lanes of vehicles and the ground that pedestrians walk on, for many positions at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from shapely import STRtree

from cosim.arrays import FloatArray, IntArray
from cosim.sumo.network import NetLane, Network

REACH_M = 10.0
"""Lanes farther away than this are ignored [m]."""
PER_RAD_M = 2.0
"""Distance added to a lane's for each radian by which its heading differs from the vehicle's [m/rad]."""
CHUNK = 50_000

SUMO_CLASS = {
    "car": "passenger",
    "van": "delivery",
    "truck": "truck",
    "bus": "bus",
    "motorcycle": "motorcycle",
    "bicycle": "bicycle",
    "pedestrian": "pedestrian",
}
"""SUMO's vehicle class for each class of road users."""


@dataclass(frozen=True, slots=True)
class Match:
    """Lanes of n positions; arrays of length n."""

    lane: IntArray
    """Index into `names`; −1 for none."""
    names: tuple[str, ...]
    across: FloatArray
    """Distance from the lane's axis, positive to its left; nan without a lane [m]."""
    along: FloatArray
    """Distance along the lane from its beginning; nan without a lane [m]."""
    angle: FloatArray
    """Heading relative to the lane's; nan without a lane [rad]."""


class LaneMatcher:
    """Finds the lanes of vehicles of one class.

    Parameters
    ----------
    network
    kind : class of the road users, a key of `SUMO_CLASS`
    """

    def __init__(self, network: Network, kind: str) -> None:
        allowed = SUMO_CLASS[kind]
        lanes = [lane for lane in network.lanes.values() if lane.permissions.allows(allowed)]
        self.names = tuple(lane.name for lane in lanes)
        self._starts, self._ends, self._lane, self._before = _segments(lanes)
        pieces: Any = shapely.linestrings(np.stack([self._starts, self._ends], axis=1))
        self._tree = STRtree(pieces)

    def match(self, x: FloatArray, y: FloatArray, heading: FloatArray) -> Match:
        """Return the lanes of vehicles at positions [m] with headings [rad]."""
        parts = [
            self._match(x[rows], y[rows], heading[rows])
            for rows in np.array_split(np.arange(len(x)), max(1, -(-len(x) // CHUNK)))
        ]
        lane, across, along, angle = (np.concatenate(columns) for columns in zip(*parts, strict=True))
        return Match(lane, self.names, across, along, angle)

    def _match(
        self, x: FloatArray, y: FloatArray, heading: FloatArray
    ) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
        count = len(x)
        point, segment = self._tree.query(shapely.points(x, y), predicate="dwithin", distance=REACH_M)
        start, way = self._starts[segment], self._ends[segment] - self._starts[segment]
        length = np.hypot(way[:, 0], way[:, 1])
        off_x, off_y = x[point] - start[:, 0], y[point] - start[:, 1]
        along = (off_x * way[:, 0] + off_y * way[:, 1]) / length
        across = (way[:, 0] * off_y - way[:, 1] * off_x) / length
        beyond = along - np.clip(along, 0.0, length)
        distance = np.hypot(beyond, across)
        turn = heading[point] - np.arctan2(way[:, 1], way[:, 0])
        angle = np.arctan2(np.sin(turn), np.cos(turn))
        cost = distance + PER_RAD_M * np.abs(angle)
        order = np.lexsort((segment, cost, point))
        first = order[np.unique(point[order], return_index=True)[1]]
        rows = point[first]
        lane = np.full(count, -1, dtype=np.int64)
        lane[rows] = self._lane[segment[first]]
        result = [np.full(count, np.nan) for _ in range(3)]
        side = np.where(across[first] < 0.0, -1.0, 1.0)
        for column, values in zip(
            result,
            (
                side * distance[first],
                self._before[segment[first]] + np.clip(along[first], 0.0, length[first]),
                angle[first],
            ),
            strict=True,
        ):
            column[rows] = values
        return lane, result[0], result[1], result[2]


def _segments(lanes: Sequence[NetLane]) -> tuple[FloatArray, FloatArray, IntArray, FloatArray]:
    """Return starts and ends of all straight pieces, their lanes, and where each begins along its lane."""
    if not lanes:
        return np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, dtype=np.int64), np.zeros(0)
    starts = np.concatenate([lane.shape[:-1] for lane in lanes])
    ends = np.concatenate([lane.shape[1:] for lane in lanes])
    owner = np.concatenate([np.full(len(lane.shape) - 1, at) for at, lane in enumerate(lanes)])
    length = np.hypot(*(ends - starts).T)
    total = np.concatenate([[0.0], np.cumsum(length)])[:-1]
    firsts = np.concatenate([[0], np.cumsum([len(lane.shape) - 1 for lane in lanes])[:-1]])
    kept = length > 1e-6
    before = total - total[firsts][owner]
    return starts[kept], ends[kept], owner[kept].astype(np.int64), before[kept]


class Walkways:
    """The ground for pedestrians: sidewalks, crossings, walking areas, and roads that they share with cars.

    Parameters
    ----------
    network
    """

    def __init__(self, network: Network) -> None:
        on_foot = [lane for lane in network.lanes.values() if lane.permissions.allows("pedestrian")]
        lanes = [lane for lane in on_foot if not lane.permissions.allows("passenger")]
        beside = {lane.edge for lane in lanes}
        # Where a road has no lane for pedestrians alone, such as a living street, they walk on the road in
        # SUMO.
        lanes += [
            lane
            for lane in on_foot
            if lane.permissions.allows("passenger") and not lane.internal and lane.edge not in beside
        ]
        crossings, areas = network.crossings.values(), network.walking_areas.values()
        strips = [(lane.edge, lane.shape, lane.width) for lane in lanes]
        strips += [(one.name, one.axis, one.width) for one in crossings]
        shapes = [
            shapely.LineString(shape).buffer(0.5 * width, cap_style="flat") for _, shape, width in strips
        ]
        shapes += [shapely.Polygon(area.outline).buffer(0.0) for area in areas if len(area.outline) > 2]
        self.names = [name for name, _, _ in strips]
        self.names += [area.name for area in areas if len(area.outline) > 2]
        self._tree = STRtree(shapes)
        self._shapes = np.array(shapes, dtype=object)

    def nearest(self, x: FloatArray, y: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the ground nearest to positions, an index into `names`, and the distance from it [m]."""
        if not len(self._shapes):
            return np.full(len(x), -1, dtype=np.int64), np.full(len(x), np.inf)
        points = shapely.points(x, y)
        found = np.asarray(self._tree.nearest(points), dtype=np.int64)
        return found, np.asarray(shapely.distance(points, self._shapes[found]), dtype=np.float64)
