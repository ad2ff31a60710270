"""A SUMO network: lanes, connections, crossings and walking areas; no simulation needed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from controllers.interface import CrossingKind
from cosim.arrays import FloatArray

CAR = "passenger"
"""Vehicle class whose lanes are roads: limits of railways are far above the speed of trams on them."""


def junction_of(internal_lane: str) -> str:
    """Return the junction after which an internal lane is named; empty for the empty name of none.

    >>> junction_of(":main_street_3_0")
    'main_street'
    """
    return internal_lane[1:].rsplit("_", 2)[0]


@dataclass(frozen=True, slots=True)
class Permissions:
    """Which vehicle classes may use a lane or a connection."""

    allow: frozenset[str] | None = None
    disallow: frozenset[str] = frozenset()

    def allows(self, vehicle_class: str) -> bool:
        """Return whether that class may use it.

        >>> Permissions(allow=frozenset({"bus"})).allows("passenger")
        False
        """
        if self.allow is not None:
            return vehicle_class in self.allow or "all" in self.allow
        return vehicle_class not in self.disallow and "all" not in self.disallow


@dataclass(frozen=True)
class NetLane:
    """One lane; internal lanes, crossings and walking areas are lanes too."""

    name: str
    edge: str
    index: int
    length: float
    """Length by which SUMO counts positions [m]; may differ from the length of the shape."""
    width: float
    speed: float
    shape: FloatArray
    """(n, 2) centre line, or the outline of a walking area [m]."""
    permissions: Permissions
    class_speeds: Mapping[str, float] = field(default_factory=dict)
    """Limits of vehicle classes that have one of their own here, which may be higher than `speed` [m/s]."""

    def limit(self, vehicle_class: str, changed: float | None = None) -> float:
        """Return the speed limit of a vehicle class [m/s].

        Parameters
        ----------
        vehicle_class : SUMO's name of the class
        changed : present limit of the lane, if it is not that of the network [m/s]
        """
        own = self.class_speeds.get(vehicle_class)
        if own is None:
            return self.speed if changed is None else changed
        return own if changed is None else min(own, changed)

    @property
    def internal(self) -> bool:
        """Whether it lies inside a junction."""
        return self.name.startswith(":")

    @cached_property
    def shape_length(self) -> float:
        """Length of the centre line [m]."""
        return float(np.hypot(*np.diff(self.shape, axis=0).T).sum())


TURNAROUND = "t"
"""Direction of a connection that turns round."""


@dataclass(frozen=True, slots=True)
class Connection:
    """Connection from one lane to another."""

    source: str
    target: str
    via: tuple[str, ...]
    """Internal lanes between the two, in driving order."""
    direction: str
    """SUMO's letter: s, l, r and so on; ``TURNAROUND`` whichever side traffic keeps to."""
    signal: str
    """Id of the traffic light that controls it; empty if there is none."""
    signal_index: int
    in_order: bool
    """Whether vehicles pass in the order in which they stopped, as at an all-way stop."""
    stop_sign: bool
    """Whether there is a stop sign; all-way stops have one at every approach."""
    permissions: Permissions


@dataclass(frozen=True, slots=True)
class NetCrossing:
    """A pedestrian crossing."""

    name: str
    """Edge id."""
    axis: FloatArray
    """(n, 2) middle line from kerb to kerb [m]."""
    width: float
    edges: frozenset[str]
    """The road edges it crosses."""
    kind: CrossingKind
    signal: str
    signal_indices: tuple[int, ...]
    refuge: bool = False
    """Whether it ends on an island from which only crossings lead on."""


@dataclass(frozen=True, slots=True)
class WalkingArea:
    """An area in which pedestrians wait and turn."""

    name: str
    outline: FloatArray


@dataclass(frozen=True, slots=True)
class Requests:
    """Right of way in a junction: the connections that conflict, and those that yield."""

    lanes: tuple[str, ...]
    """The last internal lane of each way through the junction."""
    response: tuple[str, ...]
    """By way: a digit for each way, 1 if it has to yield to it; the first way's digit is the last."""
    foes: tuple[str, ...]


class Network:
    """A network as read from a file; nothing in it changes."""

    def __init__(
        self,
        lanes: Mapping[str, NetLane],
        edges: Mapping[str, tuple[str, ...]],
        connections: Mapping[str, tuple[Connection, ...]],
        crossings: Mapping[str, NetCrossing],
        walking_areas: Mapping[str, WalkingArea],
        requests: Sequence[Requests] = (),
        geographic: bool = False,
        junctions: Mapping[str, frozenset[str]] | None = None,
    ) -> None:
        self.geographic = geographic
        """Whether it has a projection, so that SUMO can convert places to longitude and latitude."""
        self.junctions = junctions or {}
        """By edge: the junctions that it is in or between."""
        self.lanes = lanes
        self.edges = edges
        """Lane names by index; normal and internal edges."""
        self.connections = connections
        """By source lane; only connections that begin on a normal lane."""
        self.crossings = crossings
        self.walking_areas = walking_areas
        incoming: defaultdict[str, list[Connection]] = defaultdict(list)
        for group in connections.values():
            for connection in group:
                incoming[connection.target].append(connection)
        self._requests = {
            lane: (index, group) for group in requests for index, lane in enumerate(group.lanes)
        }
        self.through: Mapping[str, Connection] = {
            name: connection
            for group in connections.values()
            for connection in group
            for name in connection.via
        }
        """By internal lane: the connection that it is part of."""
        self.incoming: Mapping[str, tuple[Connection, ...]] = {
            name: tuple(group) for name, group in incoming.items()
        }

    @property
    def roads(self) -> list[str]:
        """Names of the normal edges."""
        return [name for name in self.edges if not name.startswith(":")]

    def allowed_lanes(self, edge: str, vehicle_class: str) -> list[int]:
        """Return the indices of the lanes of an edge which that class may use."""
        return [
            index
            for index, name in enumerate(self.edges[edge])
            if self.lanes[name].permissions.allows(vehicle_class)
        ]

    def lanes_over(self, crossing: NetCrossing, vehicle_class: str) -> list[NetLane]:
        """Return the lanes of the edges that a crossing crosses which that class may use."""
        return [
            self.lanes[self.edges[edge][index]]
            for edge in sorted(crossing.edges & self.edges.keys())
            for index in self.allowed_lanes(edge, vehicle_class)
        ]

    def follow(self, lane: str, edge: str, vehicle_class: str) -> list[Connection]:
        """Return the connections of a lane into an edge which that class may drive all the way."""
        return [
            connection
            for connection in self.connections.get(lane, ())
            if self.lanes[connection.target].edge == edge and self.passable(connection, vehicle_class)
        ]

    def foes(self, connection: Connection) -> list[tuple[Connection, bool]]:
        """Return the connections that meet this one in its junction, and whether it has to yield to each."""
        if not connection.via or connection.via[-1] not in self._requests:
            return []
        index, group = self._requests[connection.via[-1]]
        response, foes = group.response[index], group.foes[index]
        # The rightmost digit belongs to the first lane.
        return [
            (self.through[lane], response[-1 - other] == "1")
            for other, lane in enumerate(group.lanes)
            if foes[-1 - other] == "1"
            and lane in self.through
            and self.through[lane].source != connection.source
        ]

    def take_turns(self, one: Connection, other: Connection) -> bool:
        """Return whether each of two connections has to yield to the other and no light says who drives.

        So it is at zipper junctions, at all-way stops, and where there is no rule.
        """
        return not one.signal and (other, True) in self.foes(one) and (one, True) in self.foes(other)

    def others_in_junction(self, connection: Connection) -> list[tuple[Connection, bool]]:
        """Return all connections of a junction from other lanes, and whether this one has to yield to each.

        For a way that is not where SUMO draws it: it yields to all that SUMO does not know to meet it.
        """
        known = {foe.via[-1]: yields for foe, yields in self.foes(connection)}
        if connection.via[-1] not in self._requests:
            return []
        _, group = self._requests[connection.via[-1]]
        others = (self.through[lane] for lane in group.lanes if lane in self.through)
        return [
            (other, known.get(other.via[-1], True)) for other in others if other.source != connection.source
        ]

    @cached_property
    def fastest_crossed(self) -> float:
        """Highest speed limit of a car lane that a crossing leads over; 0 if there is none [m/s]."""
        crossed = (lane.speed for one in self.crossings.values() for lane in self.lanes_over(one, CAR))
        return max(crossed, default=0.0)

    @cached_property
    def fastest_with_priority(self) -> float:
        """Highest speed limit of a car lane from which vehicles go first; 0 if there is none [m/s]."""
        sources = (
            self.lanes[foe.source]
            for group in self.connections.values()
            for connection in group
            for foe, yields in self.foes(connection)
            if yields
        )
        return max((lane.speed for lane in sources if lane.permissions.allows(CAR)), default=0.0)

    def passable(self, connection: Connection, vehicle_class: str) -> bool:
        """Return whether that class may drive a connection, its internal lanes and its target."""
        names = (*connection.via, connection.target)
        return connection.permissions.allows(vehicle_class) and all(
            self.lanes[name].permissions.allows(vehicle_class) for name in names
        )
