"""The ground at a place: lane, crossing, walking area or nothing; positions of places named in scenarios."""

from __future__ import annotations

import difflib
import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from analysis.polylines import arc_lengths, inside
from cosim.arrays import FloatArray
from cosim.pedestrians.jaywalking import Roadside
from cosim.pedestrians.line import Line
from cosim.sumo.lane_shape import LaneShape
from cosim.sumo.network import NetLane, Network

OUTSIDE = 20.0
"""Places further than this from every lane, crossing and walking area are outside the network [m]."""
CELL = 25.0
"""Size of the cells by which places are looked up [m]."""
SEAM = 0.02
"""Lanes that touch may be drawn this far apart, because networks are written to the centimetre [m]."""
ON_FOOT = frozenset({"pedestrian", "bicycle", "wheelchair"})
"""A lane that only these classes may use is not part of the carriageway."""


@dataclass(frozen=True, slots=True)
class _Strip:
    """A lane or a crossing."""

    rank: int
    """Where several strips overlap, the one with the lowest rank counts."""
    name: str
    shape: FloatArray
    half: float
    road: bool
    box: tuple[float, float, float, float]

    def contains(self, x: float, y: float) -> bool:
        low_x, low_y, high_x, high_y = self.box
        if not (low_x <= x <= high_x and low_y <= y <= high_y):
            return False
        return _from_line(self.shape, x, y, ends=False) <= self.half + SEAM


@dataclass(frozen=True, slots=True)
class Spot:
    """The ground at a place."""

    edge: str
    """Edge of the crossing, lane or walking area; empty outside all of them."""
    crossing: str = ""
    on_road: bool = False
    """Whether vehicles drive there: on a lane for them, in a junction or on a crossing."""


class Ground:
    """Looks up places in a network.

    Parameters
    ----------
    network
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._shapes: dict[str, LaneShape] = {}
        self._strips: list[_Strip] = []
        self._crossings: dict[tuple[int, int], list[_Strip]] = {}
        self._areas: list[tuple[str, FloatArray]] = []
        self._cells: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
        for crossing in network.crossings.values():
            self._add(0, crossing.name, crossing.axis, 0.5 * crossing.width, True)
        for lane in network.lanes.values():
            road = _is_for_vehicles(lane)
            self._add(3 if lane.internal else 1, lane.edge, lane.shape, 0.5 * lane.width, road)
        for area in network.walking_areas.values():
            self._areas.append((area.name, area.outline))
            self._enter(area.outline, -len(self._areas))

    def at(self, x: float, y: float) -> Spot:
        """Return what is at a place [m]: a crossing, else a lane, walking area or way through a junction."""
        best = (4, "", False)
        for index in self._near(x, y):
            if index < 0:
                name, outline = self._areas[-index - 1]
                if inside(outline, np.array([[x, y]])).all():
                    best = min(best, (2, name, False))
                continue
            strip = self._strips[index]
            if strip.rank <= best[0] and strip.contains(x, y):
                best = min(best, (strip.rank, strip.name, strip.road))
        return Spot(best[1], best[1] if best[0] == 0 else "", best[2])

    def first_crossing(self, points: FloatArray) -> str:
        """Return the crossing under the first of the points (n, 2) that is on one; empty if none is."""
        for x, y in points.tolist():
            cell = math.floor(x / CELL), math.floor(y / CELL)
            if cell not in self._crossings:
                near = [self._strips[index] for index in self._cells.get(cell, []) if index >= 0]
                self._crossings[cell] = [strip for strip in near if strip.rank == 0]
            for strip in self._crossings[cell]:
                if strip.contains(x, y):
                    return strip.name
        return ""

    def check_inside(self, points: FloatArray) -> int | None:
        """Return the index of the first of the points (n, 2) more than 20 m outside; ``None`` if none is."""
        for number, (x, y) in enumerate(points.tolist()):
            if not any(self._distance(index, x, y) <= OUTSIDE for index in self._near(x, y)):
                return number
        return None

    def on_lane(self, lane: str, along: float, across: float) -> tuple[float, float]:
        """Return the position [m] of a place given along a lane and to the left of its middle [m].

        Raises
        ------
        ValueError
            If there is no such lane, or the place is not on it.
        """
        found = self._network.lanes.get(lane)
        if found is None:
            raise ValueError(f"no lane '{lane}' in the network{_hint(lane, self._network.lanes)}")
        if not 0.0 <= along <= found.length:
            raise ValueError(
                f"lane '{lane}' is {found.length:g} m long; expected a place on it, got {along:g} m"
            )
        shape = self._shape(found)
        return shape.point(along / shape.scale, across)

    def roadside(self, edge: str, opposite: str, along: float) -> Roadside:
        """Return the carriageway at a place along an edge, with the lanes of the opposite edge.

        Raises
        ------
        ValueError
            If there is no such edge, it has no lane for vehicles, or the place is not on it.
        """
        first, *others = self._carriageway(edge)
        others += self._carriageway(opposite) if opposite else []
        middle = self.on_lane(first.name, along, 0.0)
        ahead = self._shape(first)
        # Where traffic keeps left, lanes are counted from the left and the opposite ones lie to the right.
        borders = (self._across(ahead, lane, middle) - 0.5 * lane.width for lane in others)
        right = min([-0.5 * first.width, *borders])
        x, y = self.on_lane(first.name, along, right)
        place = ahead.place(x, y).along
        (x0, y0), (x1, y1) = ahead.point(place - 0.5, 0.0), ahead.point(place + 0.5, 0.0)
        heading = math.atan2(y1 - y0, x1 - x0)
        width = max(abs(self._shape(lane).place(x, y).across) + 0.5 * lane.width for lane in (first, *others))
        return Roadside(x, y, heading, width)

    def crossing(self, name: str) -> Line:
        """Return a crossing's axis.

        Raises
        ------
        ValueError
            If there is no such crossing.
        """
        found = self._network.crossings.get(name)
        if found is None:
            exist = ", ".join(sorted(self._network.crossings)[:8]) or "none"
            raise ValueError(f"no crossing '{name}' in the network; there are: {exist}")
        return Line(*found.axis[0].tolist(), *found.axis[-1].tolist())

    def _carriageway(self, edge: str) -> list[NetLane]:
        """Return an edge's lanes for vehicles, in SUMO's order: from the outside of the road."""
        names = self._network.edges.get(edge)
        if names is None:
            raise ValueError(f"no edge '{edge}' in the network{_hint(edge, self._network.edges)}")
        lanes = [lane for lane in map(self._network.lanes.__getitem__, names) if _is_for_vehicles(lane)]
        if not lanes:
            raise ValueError(f"edge '{edge}' has no lane for vehicles")
        return lanes

    def _across(self, seen_from: LaneShape, lane: NetLane, point: tuple[float, float]) -> float:
        """Return how far a lane is to the left of another one, where it is nearest to a point [m]."""
        shape = self._shape(lane)
        return seen_from.place(*shape.point(shape.place(*point).along, 0.0)).across

    def _shape(self, lane: NetLane) -> LaneShape:
        if lane.name not in self._shapes:
            points = tuple((float(x), float(y)) for x, y in lane.shape)
            stations = tuple(arc_lengths(lane.shape).tolist())
            self._shapes[lane.name] = LaneShape(
                lane.name, lane.edge, lane.index, lane.width, lane.length, points, stations
            )
        return self._shapes[lane.name]

    def _add(self, rank: int, name: str, shape: FloatArray, half: float, road: bool) -> None:
        margin = half + SEAM
        low, high = (shape.min(axis=0) - margin).tolist(), (shape.max(axis=0) + margin).tolist()
        self._strips.append(_Strip(rank, name, shape, half, road, (*low, *high)))
        self._enter(shape, len(self._strips) - 1)

    def _enter(self, shape: FloatArray, index: int) -> None:
        reach = OUTSIDE + 5.0
        low = np.floor((shape.min(axis=0) - reach) / CELL).astype(int)
        high = np.floor((shape.max(axis=0) + reach) / CELL).astype(int)
        for column in range(low[0], high[0] + 1):
            for row in range(low[1], high[1] + 1):
                self._cells[column, row].append(index)

    def _near(self, x: float, y: float) -> list[int]:
        return self._cells.get((math.floor(x / CELL), math.floor(y / CELL)), [])

    def _distance(self, index: int, x: float, y: float) -> float:
        if index >= 0:
            strip = self._strips[index]
            return _from_line(strip.shape, x, y) - strip.half
        _, outline = self._areas[-index - 1]
        if inside(outline, np.array([[x, y]])).all():
            return 0.0
        return _from_line(np.concatenate([outline, outline[:1]]), x, y)


def _is_for_vehicles(lane: NetLane) -> bool:
    return lane.permissions.allow is None or not lane.permissions.allow <= ON_FOOT


def _from_line(shape: FloatArray, x: float, y: float, ends: bool = True) -> float:
    """Return the distance from a polyline [m]; if ``ends`` is false, inf beyond its ends."""
    start, step = shape[:-1], np.diff(shape, axis=0)
    square = np.maximum((step**2).sum(axis=1), 1e-12)
    share = ((x - start[:, 0]) * step[:, 0] + (y - start[:, 1]) * step[:, 1]) / square
    inside = np.clip(share, 0.0, 1.0)
    nearest = start + inside[:, None] * step
    distance = np.hypot(nearest[:, 0] - x, nearest[:, 1] - y)
    best = int(np.argmin(distance))
    beyond = (best == 0 and share[0] < 0.0) or (best == len(share) - 1 and share[-1] > 1.0)
    return math.inf if beyond and not ends else float(distance[best])


def _hint(name: str, known: Iterable[str]) -> str:
    names = [one for one in known if not one.startswith(":")]
    near = difflib.get_close_matches(name, names, n=3)
    some = ", ".join(near) if near else ", ".join(sorted(names)[:5])
    return f"; there are, for instance: {some}" if some else ""
