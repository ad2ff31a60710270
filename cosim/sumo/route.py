"""A route through the network, lane by lane: where each lane leads, and the path that follows it."""

from __future__ import annotations

import difflib
import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cosim.arrays import FloatArray
from cosim.errors import InputError
from cosim.sumo.bends import CAR, Turning
from cosim.sumo.lane_chain import joined
from cosim.sumo.lane_path import LanePath
from cosim.sumo.network import TURNAROUND, Connection, NetLane, Network

VIEW = 250.0
"""A path reaches this far beyond the end of its edge [m]."""
BEHIND = 80.0
"""A path reaches back this far before its edge [m]."""


class Route:
    """A route for a vehicle class, and the paths along its lanes.

    Parameters
    ----------
    network
    edges : names, in driving order
    vehicle_class : SUMO's name of the class
    turning : how tightly the vehicle turns

    Raises
    ------
    InputError
        If an edge does not exist, may not be used by the class, or does not follow the one before.
    """

    def __init__(
        self, network: Network, edges: Sequence[str], vehicle_class: str, turning: Turning = CAR
    ) -> None:
        self.network = network
        self.edges = tuple(edges)
        self.vehicle_class = vehicle_class
        self.turning = turning
        check_route(network, self.edges, vehicle_class)
        self._reach = self._reaches()
        self._paths: dict[tuple[int, int], LanePath] = {}
        self._beside: dict[tuple[int, int], tuple[tuple[tuple[int, LanePath], ...], ...]] = {}

    def lane(self, step: int, index: int) -> NetLane:
        """Return a lane of the route's edge number ``step``."""
        return self.network.lanes[self.network.edges[self.edges[step]][index]]

    def usable(self, step: int, index: int) -> bool:
        """Return whether that lane exists and the class may use it."""
        names = self.network.edges[self.edges[step]]
        return 0 <= index < len(names) and self.lane(step, index).permissions.allows(self.vehicle_class)

    def reach(self, step: int, index: int) -> float:
        """Return how far a lane leads along the route from its beginning [m]; inf if to the route's end."""
        return self._reach[step].get(index, 0.0)

    def path(self, step: int, index: int) -> LanePath:
        """Return the path along a lane, made on first use."""
        key = (step, index)
        if key not in self._paths:
            self._paths[key] = self._path(step, index)
        return self._paths[key]

    def beside(self, step: int, index: int) -> tuple[tuple[tuple[int, LanePath], ...], ...]:
        """Return the usable lanes to the right of a lane, then those to its left, nearest first; with paths.

        They are found on first use, because neither the network nor the route changes.
        """
        key = (step, index)
        if key not in self._beside:
            self._beside[key] = (self._usable(step, index, -1), self._usable(step, index, 1))
        return self._beside[key]

    def _usable(self, step: int, index: int, direction: int) -> tuple[tuple[int, LanePath], ...]:
        found = []
        while self.usable(step, index := index + direction):
            found.append((index, self.path(step, index)))
        return tuple(found)

    def next_lane(self, step: int, index: int) -> int | None:
        """Return the index of the lane on the next edge that continues this one best."""
        connection = self._onward(step, index)
        return None if connection is None else self.network.lanes[connection.target].index

    def _reaches(self) -> list[dict[int, float]]:
        last = len(self.edges) - 1
        reaches: list[dict[int, float]] = [{} for _ in self.edges]
        reaches[last] = dict.fromkeys(
            self.network.allowed_lanes(self.edges[last], self.vehicle_class), math.inf
        )
        for step in range(last - 1, -1, -1):
            for index in self.network.allowed_lanes(self.edges[step], self.vehicle_class):
                onward = [
                    sum(self.network.lanes[name].shape_length for name in connection.via)
                    + reaches[step + 1].get(self.network.lanes[connection.target].index, 0.0)
                    for connection in self._connections(step, index)
                ]
                reaches[step][index] = self.lane(step, index).shape_length + max(onward, default=0.0)
        return reaches

    def _connections(self, step: int, index: int) -> list[Connection]:
        if step + 1 >= len(self.edges):
            return []
        name = self.lane(step, index).name
        return self.network.follow(name, self.edges[step + 1], self.vehicle_class)

    def _onward(self, step: int, index: int) -> Connection | None:
        """Return the connection that leads furthest; among equal ones, the one that best keeps the lane."""
        return max(
            self._connections(step, index),
            key=lambda connection: (
                self.reach(step + 1, self.network.lanes[connection.target].index),
                -abs(self.network.lanes[connection.target].index - index),
            ),
            default=None,
        )

    def _onward_beside(self, step: int, index: int) -> Connection | None:
        """Return the connection of the nearest lane that leads along the route; ``None`` if there is none."""
        others = self.network.allowed_lanes(self.edges[step], self.vehicle_class)
        found = (self._onward(step, other) for other in sorted(others, key=lambda one: abs(one - index)))
        return next((connection for connection in found if connection is not None), None)

    def _backward(self, step: int, index: int) -> Connection | None:
        incoming = [
            connection
            for connection in self.network.incoming.get(self.lane(step, index).name, ())
            if self.network.passable(connection, self.vehicle_class)
            and self.network.lanes[connection.source].permissions.allows(self.vehicle_class)
        ]
        if step <= 0:
            incoming = [c for c in incoming if c.direction != TURNAROUND]
        else:
            before = self.edges[step - 1]
            incoming = [c for c in incoming if self.network.lanes[c.source].edge == before]
        return max(incoming, key=lambda connection: connection.direction == "s", default=None)

    def _path(self, step: int, index: int) -> LanePath:
        lanes: list[tuple[NetLane, int]] = [(self.lane(step, index), step)]
        connections: list[Connection] = []
        beyond, at, lane = 0.0, step, index
        leads_to_end = step == len(self.edges) - 1
        beside: Connection | None = None
        while beyond < VIEW:
            connection = self._onward(at, lane)
            if connection is None:
                leads_to_end = at == len(self.edges) - 1
                beside = self._onward_beside(at, lane)
                break
            connections.append(connection)
            added = [self.network.lanes[name] for name in connection.via]
            at, lane = at + 1, self.network.lanes[connection.target].index
            lanes += [(part, at - 1) for part in added] + [(self.lane(at, lane), at)]
            beyond += sum(part.shape_length for part in added) + self.lane(at, lane).shape_length
            leads_to_end = False
        before, entering, shift = self._before(step, index)
        polyline, origin, pieces = joined([(part, step - 1) for part in before], lanes, shift)
        path = LanePath(polyline, origin, pieces, leads_to_end, step, self.turning, self.vehicle_class)
        edges = {part.edge for part, _ in lanes if not part.internal}
        edges |= {part.edge for part in before if not part.internal}
        crossings = [c for c in self.network.crossings.values() if c.edges & edges]
        path.meet(crossings, [*entering, *connections])
        if beside is not None:
            path.leave_beside(beside, sum(self.network.lanes[name].shape_length for name in beside.via))
        return path

    def _before(self, step: int, index: int) -> tuple[list[NetLane], list[Connection], FloatArray]:
        """Return the lanes that lead to a lane, in driving order, and the connections between them.

        If no lane leads to it because it begins on this edge, the lanes are those of the nearest lane beside
        it that has some, and the third value is the shift that they need [m].
        """
        lanes: list[NetLane] = []
        connections: list[Connection] = []
        gone, at, lane = 0.0, step, index
        connection = self._backward(at, lane)
        shift = np.zeros(2)
        if connection is None:
            usable = self.network.allowed_lanes(self.edges[step], self.vehicle_class)
            for other in sorted(usable, key=lambda other: abs(other - index)):
                connection = self._backward(step, other)
                if connection is not None:
                    shift = self.lane(step, index).shape[0] - self.lane(step, other).shape[0]
                    break
        while connection is not None and gone < BEHIND:
            source = self.network.lanes[connection.source]
            added = [source, *(self.network.lanes[name] for name in connection.via)]
            lanes = added + lanes
            connections.insert(0, connection)
            gone += sum(part.shape_length for part in added)
            at, lane = at - 1, source.index
            if at < 0:
                break
            connection = self._backward(at, lane)
        return lanes, connections, shift


def check_route(network: Network, edges: Sequence[str], vehicle_class: str) -> None:
    """Raise `InputError` naming the first edge that a route of that class cannot contain."""
    if not edges:
        raise InputError('a route needs at least one edge, for instance "e1 e2 e3"')
    for number, edge in enumerate(edges):
        if edge.startswith(":") or edge not in network.edges:
            near = _similar(network, edge)
            raise InputError(f'route edge {number + 1} "{edge}" is not in the network; {near}')
        if not network.allowed_lanes(edge, vehicle_class):
            raise InputError(f'route edge {number + 1} "{edge}" has no lane for a {vehicle_class} vehicle')
    for number, (edge, following) in enumerate(pairwise(edges)):
        lanes = [network.edges[edge][index] for index in network.allowed_lanes(edge, vehicle_class)]
        if not any(network.follow(lane, following, vehicle_class) for lane in lanes):
            raise InputError(
                f'route edge {number + 2} "{following}" does not follow "{edge}" for a {vehicle_class} '
                f"vehicle; after it come {_after(network, lanes, vehicle_class)}"
            )


def _after(network: Network, lanes: Sequence[str], vehicle_class: str) -> str:
    names = {
        network.lanes[connection.target].edge
        for lane in lanes
        for connection in network.connections.get(lane, ())
        if network.passable(connection, vehicle_class)
    }
    return ", ".join(f'"{name}"' for name in sorted(names)[:8]) or "no edges"


def _similar(network: Network, edge: str) -> str:
    """Return a hint with the existing edges whose names are most similar to the given one."""
    roads = network.roads
    near = difflib.get_close_matches(edge, roads, n=5, cutoff=0.3) or sorted(roads)[:5]
    names = ", ".join(f'"{name}"' for name in near)
    return f"the network has {len(roads)} edges, for instance {names}"
