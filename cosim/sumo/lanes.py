"""Lanes of the running simulation, each queried once: their neighbours, and where they lead."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

from cosim.sumo.lane_shape import LaneShape, Place

PAST_END = 1.0
"""Up to this far before a lane's beginning, SUMO has a vehicle near its centre line on that lane [m]."""
MIDDLE = 0.5
"""Largest offset from the centre line at which a vehicle is near it [m]."""
AT_BEGINNING = 0.1
"""Nearer to the beginning, SUMO may not: other ways of the junction end or begin there too [m]."""
INSIDE_END = 0.01
"""Vehicles that would be beyond a lane's end are put this far inside it [m]."""
TOUCH = 0.05
"""A body has to reach this far into its lane to be on it [m]."""
FLAT = 0.01
"""Differences up to this between lane positions and distances along the shape are ignored [m]."""
NEXT_EDGES = 8
"""A vehicle's lane is searched among this many edges of the rest of its route."""


@dataclass(frozen=True, slots=True)
class LaneLink:
    """A way out of a lane."""

    lane: str
    """Next normal lane."""
    via: str
    """Lane inside the junction on the way there; empty if there is none."""

    @property
    def first(self) -> str:
        """Lane entered next."""
        return self.via or self.lane


class Lanes:
    """Lanes by name. ``connection`` is the libsumo module or a traci connection."""

    def __init__(self, connection: Any) -> None:
        self._connection = connection
        self._shapes: dict[str, LaneShape] = {}
        self._links: dict[str, tuple[LaneLink, ...]] = {}
        self._paved: dict[tuple[str, str], tuple[float, float]] = {}
        self._beside: dict[tuple[str, str], tuple[LaneShape, ...]] = {}
        self._inside: dict[tuple[str, str], frozenset[str]] = {}
        self._junctions: dict[str, tuple[str, str]] = {}
        self._banned: dict[str, frozenset[str]] = {}

    def shape(self, name: str) -> LaneShape:
        """Return a lane's shape."""
        found = self._shapes.get(name)
        if found is None:
            found = self._shapes[name] = self._read(name)
        return found

    def links(self, name: str) -> tuple[LaneLink, ...]:
        """Return a lane's ways out."""
        found = self._links.get(name)
        if found is None:
            rows = self._connection.lane.getLinks(name)
            found = self._links[name] = tuple(LaneLink(row[0], row[4]) for row in rows)
        return found

    def permits(self, name: str, vehicle_class: str) -> bool:
        """Return whether vehicles of that class may use the lane."""
        banned = self._banned.get(name)
        if banned is None:
            banned = self._banned[name] = frozenset(self._connection.lane.getDisallowed(name))
        return vehicle_class not in banned

    def beside(self, lane: LaneShape, vehicle_class: str) -> tuple[LaneShape, ...]:
        """Return all lanes of the same edge that the class may use, right to left."""
        key = (lane.edge, vehicle_class)
        found = self._beside.get(key)
        if found is None:
            count = self._connection.edge.getLaneNumber(lane.edge)
            names = (f"{lane.edge}_{index}" for index in range(count))
            found = tuple(self.shape(name) for name in names if self.permits(name, vehicle_class))
            self._beside[key] = found
        return found

    def paved(self, lane: LaneShape, vehicle_class: str, width: float, across: float) -> bool:
        """Return whether a body [m] stays within the lane and the permitted lanes next to it."""
        key = (lane.name, vehicle_class)
        sides = self._paved.get(key)
        if sides is None:
            right = left = 0.5 * lane.width
            for other in self.beside(lane, vehicle_class):
                # Where traffic keeps left, lanes are counted from left to right.
                if other.index == lane.index - 1:
                    right += other.width
                elif other.index == lane.index + 1:
                    left += other.width
            sides = self._paved[key] = right, left
        return 0.5 * width - sides[0] <= self._upwards * across <= sides[1] - 0.5 * width

    def on_way(self, edge: str, route: tuple[str, ...]) -> bool:
        """Return whether an edge, perhaps one inside a junction, belongs to the next edges of a route."""
        if not edge.startswith(":"):
            return edge in route
        return any(edge in self.inside(*pair) for pair in pairwise(route[:NEXT_EDGES]))

    def inside(self, edge: str, onward: str) -> frozenset[str]:
        """Return the edges inside the junction on the ways from one edge to the next."""
        key = (edge, onward)
        found = self._inside.get(key)
        if found is None:
            lanes: set[str] = set()
            for index in range(self._connection.edge.getLaneNumber(edge)):
                for link in self.links(f"{edge}_{index}"):
                    # Lanes of one edge inside a junction may go on in different edges.
                    ahead = [link.via] if _edge(link.lane) == onward and link.via else []
                    while ahead:
                        via = ahead.pop()
                        if via not in lanes:
                            lanes.add(via)
                            ahead += [on.via for on in self.links(via) if on.via]
            found = self._inside[key] = frozenset(map(_edge, lanes))
        return found

    def found_on_route(
        self,
        lane: LaneShape,
        driven: tuple[str, ...],
        route: tuple[str, ...],
        width: float,
        x: float,
        y: float,
    ) -> bool:
        """Return whether SUMO finds a vehicle by its place [m] if only the lanes of its route count.

        In a junction and between two lanes, another lane is often nearer than the one given to SUMO, because
        the front bumper swings out in a bend. But if the route passes the same junction before or after, a
        lane of that passage might be nearer too.

        Parameters
        ----------
        lane : lane that the vehicle should be on
        driven : edges of the route before the present one
        route : edges from the present one on
        width : width of the vehicle [m]
        x, y : centre of the front bumper [m]
        """
        if lane.no_direction:
            return False
        place = lane.place(x, y)
        past = max(-place.along, place.along - lane.shape_length, 0.0)
        aside = 0.5 * (lane.width + width) - TOUCH
        if not (lane.internal or past > 0.0) or math.hypot(past, place.across) > aside:
            return False
        here = _junction(lane.edge) if lane.internal else self._ends(lane.edge)[place.along > 0.0]
        return self._passed(driven + route).count(here) == 1

    def meets_again(self, driven: tuple[str, ...], route: tuple[str, ...]) -> bool:
        """Return whether the present edge begins or ends at a junction that was passed before.

        Parameters
        ----------
        driven : edges of the route before the present one
        route : edges from the present one on
        """
        passed = self._passed(driven + route[:1])
        return not set(passed[-2:]).isdisjoint(passed[:-2])

    def _passed(self, edges: tuple[str, ...]) -> list[str]:
        """Return the junctions at the beginning of a route and at the end of each of its edges."""
        return [self._ends(edge)[0] for edge in edges[:1]] + [self._ends(edge)[1] for edge in edges]

    def _ends(self, edge: str) -> tuple[str, str]:
        """Return the junctions where an edge begins and where it ends."""
        found = self._junctions.get(edge)
        if found is None:
            asked = self._connection.edge
            found = self._junctions[edge] = asked.getFromJunction(edge), asked.getToJunction(edge)
        return found

    def placeable(
        self, lane: LaneShape, width: float, x: float, y: float, heading: float, astray: bool = False
    ) -> tuple[float, float, float]:
        """Return the pose nearest to the given one at which SUMO keeps a vehicle on a lane.

        For SUMO, a vehicle whose body does not reach into its lane is on no lane. Just before or beyond the
        lane's ends, as in the wedge outside a bend, SUMO ignores the lane that it is told: it puts the
        vehicle on a lane that fits better, and the vehicle loses its route. The same holds in a junction if
        the vehicle is nearer to the middle of another way. On the lane's centre line, SUMO always obeys.

        Parameters
        ----------
        lane : lane that the vehicle should be on
        width : width of the vehicle [m]
        x, y : centre of the front bumper [m]
        heading : heading of the vehicle [rad]
        astray : whether SUMO has it on another way, from which it has to be brought back
        """
        if lane.no_direction:
            return x, y, heading
        place = lane.place(x, y)
        aside = 0.5 * (lane.width + width) - TOUCH
        past = max(-place.along, place.along - lane.shape_length)
        # Beyond the last lane of a route SUMO makes the route longer, which stops of the demand may forbid.
        near_start = -PAST_END <= place.along < -AT_BEGINNING and abs(place.across) <= MIDDLE
        if not astray and (near_start or (past <= 0.0 and abs(place.across) <= aside)):
            return x, y, heading
        if lane.internal:
            aside = 0.5 * lane.width
        inside = min(INSIDE_END, 0.5 * lane.shape_length)
        along = min(max(place.along, inside), lane.shape_length - inside)
        x, y = lane.point(along, 0.0 if astray else min(max(place.across, -aside), aside))
        return x, y, lane.heading(x, y) if lane.internal or past > PAST_END else heading

    def counted(
        self, lane: LaneShape, place: Place, vehicle_class: str, x: float, y: float
    ) -> tuple[float, float] | None:
        """Return SUMO's lane position and lateral position [m] that bring a vehicle of that lane to a point.

        SUMO counts lateral positions, like its lanes, to the left where traffic keeps right, and to the right
        where it keeps left.

        When a vehicle passes the side of its lane, SUMO changes to the next lane and keeps the lane position,
        which in a bend is another point of the road. The point is then located from the next lane. ``None``
        if the two lanes disagree on whether the vehicle has passed the side.

        Parameters
        ----------
        lane : lane of the vehicle
        place : place of the point, seen from that lane
        vehicle_class : SUMO's name of the vehicle's class
        x, y : the point [m]
        """
        if abs(place.across) <= 0.5 * lane.width:
            return lane.position(place.along), self._upwards * place.across
        side = 1 if self._upwards * place.across > 0.0 else -1
        for other in self.beside(lane, vehicle_class):
            if other.index == lane.index + side:
                there = other.place(x, y)
                across = self._upwards * there.across + side * 0.5 * (lane.width + other.width)
                if abs(across) > 0.5 * lane.width:
                    return other.position(there.along), across
        return None

    @cached_property
    def _upwards(self) -> float:
        """1 if the lanes of an edge are counted from right to left, −1 if from left to right."""
        edges = self._connection.edge
        for edge in edges.getIDList():
            if not edge.startswith(":") and edges.getLaneNumber(edge) > 1:
                first, second = self.shape(f"{edge}_0"), self.shape(f"{edge}_1")
                if first.shape_length > 1.0 and second.shape_length > 1.0:
                    middle = second.point(0.5 * second.shape_length, 0.0)
                    return math.copysign(1.0, first.place(*middle).across)
        return 1.0

    def reach(
        self, start: LaneShape, route: tuple[str, ...], vehicle_class: str, x: float, y: float
    ) -> tuple[LaneShape, float]:
        """Return the lane a point [m] is on, and its lane position [m] counted from the start's beginning.

        Of lanes side by side, it is the nearest one. Beyond a lane's end, it is the one that leads along the
        route (edges from the start's on), however many short lanes lie in between.
        """
        lane = self._nearest(start, vehicle_class, x, y)
        place = lane.place(x, y)
        before = 0.0
        while place.along > lane.shape_length:
            following = self._following(lane, route, vehicle_class)
            if following is None:
                break
            before += lane.length
            lane = self._nearest(following, vehicle_class, x, y)
            place = lane.place(x, y)
        return lane, before + lane.position(place.along)

    def _nearest(self, lane: LaneShape, vehicle_class: str, x: float, y: float) -> LaneShape:
        if abs(lane.place(x, y).across) <= 0.5 * lane.width:
            return lane  # lanes in a junction that spread from one lane overlap: stay on the one taken
        candidates = self.beside(lane, vehicle_class) or (lane,)
        return min(candidates, key=lambda candidate: abs(candidate.place(x, y).across))

    def _following(self, lane: LaneShape, route: tuple[str, ...], vehicle_class: str) -> LaneShape | None:
        """Return the lane after this one along the route; ``None`` where the route ends."""
        if lane.internal:
            links = self.links(lane.name)
            return self.shape(links[0].first) if links else None
        if lane.edge not in route[:-1]:
            return None
        onward = route[route.index(lane.edge) + 1]
        beyond = route[route.index(lane.edge) + 2 :][:1]
        # If the lane does not lead there, the controller is in a wrong one: use the nearest one that does.
        ways = sorted(self.beside(lane, vehicle_class), key=lambda other: abs(other.index - lane.index))
        for way in ways:
            leading = [link for link in self.links(way.name) if _edge(link.lane) == onward]
            if leading:
                # Where one lane spreads into several, prefer one that leads on to the edge after the next.
                good = [
                    link for link in leading if any(_edge(on.lane) in beyond for on in self.links(link.lane))
                ]
                return self.shape((good or leading)[0].first)
        return None

    def _read(self, name: str) -> LaneShape:
        lane = self._connection.lane
        shape = lane.getShape(name)
        stations = [0.0]
        for start, end in pairwise(shape):
            stations.append(stations[-1] + math.dist(start, end))
        found = LaneShape(
            name=name,
            edge=lane.getEdgeID(name),
            index=int(name.rpartition("_")[2]),
            width=lane.getWidth(name),
            length=lane.getLength(name),
            points=tuple((point[0], point[1]) for point in shape),
            stations=tuple(stations),
        )
        return replace(found, positions=self._positions(found))

    def _positions(self, lane: LaneShape) -> tuple[float, ...]:
        """Return SUMO's lane position [m] of each point of a shape; empty if they are proportional."""
        if len(lane.points) < 3 or abs(lane.length - lane.shape_length) <= FLAT:
            return ()
        convert = self._connection.simulation.convert2D

        def along(position: float) -> float:
            return lane.place(*convert(lane.edge, position, lane.index)[:2]).along

        inner = lane.stations[1:-1]
        if all(abs(along(station * lane.scale) - station) <= FLAT for station in inner):
            return ()
        tenth_mm = range(int(1e4 * lane.length))
        found = (bisect_left(tenth_mm, station, key=lambda one: along(1e-4 * one)) for station in inner)
        return (0.0, *(1e-4 * one for one in found), lane.length)


def _edge(lane: str) -> str:
    return lane.rpartition("_")[0]


def _junction(edge: str) -> str:
    """Return the junction that an edge is inside.

    >>> _junction(":town_hall_12")
    'town_hall'
    """
    return edge[1:].rpartition("_")[0]
