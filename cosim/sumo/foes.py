"""Vehicles whose ways cross or join an ego's own inside a junction ahead.

SUMO's own list (``vehicle.getJunctionFoes``) stayed empty for a left turn against oncoming traffic in
1.28, so foes are found from the network. The junction's right-of-way table says which ways meet, their
geometry says where they meet, and lanes and routes say which vehicles come along a way.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from analysis.polylines import arc_lengths
from controllers.interface import JunctionFoe
from cosim.arrays import FloatArray
from cosim.sumo.approaches import Approaches
from cosim.sumo.lane_path import WAY_SPACING, DrawnWay, PathJunction
from cosim.sumo.lights import Lights
from cosim.sumo.network import Connection, Network
from cosim.sumo.present import forget_absent
from cosim.sumo.road_users import Cars
from cosim.sumo.sight import foe_range, sight

CLEARANCE = 2.0
"""Ways nearer to each other than this are in conflict: a car's width plus 0.2 m [m]."""
AWAY = 1.0
"""An ego whose way meets others before the end of its lane stops this far before it does [m]."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """Where two ways through a junction are too near; distances from the beginning of each way [m]."""

    foe: Connection
    must_yield: bool
    in_turn: bool
    """Whether those who wait take turns, as both have to yield."""
    entry: float
    exit: float
    foe_entry: float
    foe_exit: float
    foe_range: float
    """Vehicles farther from the conflict are not considered yet [m]."""


class FoeFinder:
    """Finds junction foes; keeps the geometry of conflicts and the vehicles' next ways.

    Parameters
    ----------
    sumo : module or connection
    network
    """

    def __init__(self, sumo: Any, network: Network) -> None:
        self._sumo = sumo
        self._network = network
        self._farthest = sight(network).vehicles
        self._conflicts: dict[tuple[str, bytes], Mapping[str, Sequence[Conflict]]] = {}
        self._ways: dict[str, tuple[tuple[str, str], tuple[tuple[str, float], ...]]] = {}
        """By vehicle: the lane and the route for which its next ways were found, and those ways."""
        self._approaches = Approaches(network)

    def begin(self, cars: Cars, time: float) -> None:
        """Begin an instant [s]: forget vehicles that are no longer near any ego."""
        forget_absent(self._ways, cars.names)
        self._approaches.begin(cars, time)

    def find(
        self,
        name: str,
        origin: float,
        junctions: Sequence[PathJunction],
        near: Sequence[int],
        cars: Cars,
        lights: Lights,
    ) -> list[JunctionFoe]:
        """Return the foes of one ego, nearest conflict first.

        Parameters
        ----------
        name : name of the ego
        origin : place of its rear axle on its path [m]
        junctions : junctions that the ego is in or reaches soon
        near : rows of the vehicles near the ego
        cars : the vehicles near all egos
        lights : traffic lights at this instant
        """
        found: list[JunctionFoe] = []
        for junction in junctions:
            conflicts = self._conflicts_of(junction)
            if conflicts:
                found += self._coming(name, origin, junction, conflicts, near, cars, lights)
        return sorted(found, key=lambda foe: (foe.entry, foe.name))

    def _coming(
        self,
        name: str,
        origin: float,
        junction: PathJunction,
        conflicts: Mapping[str, Sequence[Conflict]],
        near: Sequence[int],
        cars: Cars,
        lights: Lights,
    ) -> list[JunctionFoe]:
        start = junction.start - origin
        waits = None if junction.waiting_place is None else junction.waiting_place - origin
        own = junction.connection
        has_priority = lights.letter(own.signal, own.signal_index) == "G"
        found = []
        for row in near:
            for way, offset in self._ways_of(cars.names[row], cars.lane[row], cars.route[row]):
                for conflict in conflicts.get(way, ()):
                    before = offset - float(cars.lane_position[row])
                    foe_entry = before + conflict.foe_entry
                    foe_exit = before + conflict.foe_exit + float(cars.length[row])
                    before_line = before > 0.0
                    if foe_exit < 0.0 or foe_entry > conflict.foe_range:
                        continue
                    if before_line and _stopped(conflict.foe, lights):
                        continue
                    foe = cars.names[row]
                    first = before_line and self._goes_first(own, conflict, name, foe)
                    found.append(
                        JunctionFoe(
                            foe,
                            start + conflict.entry,
                            start + conflict.exit,
                            start + (0.0 if conflict.entry >= 0.0 else conflict.entry - AWAY),
                            foe_entry,
                            foe_exit,
                            # A vehicle cannot arrive before slower vehicles ahead of it in its lane.
                            self._approaches.pace(row) if before_line else float(cars.speed[row]),
                            conflict.must_yield and not has_priority and not first,
                            waits,
                        )
                    )
        return found

    def _goes_first(self, own: Connection, conflict: Conflict, name: str, foe: str) -> bool:
        """Return whether an ego need not yield to a foe before its line, as it came to the junction first.

        Where two have to yield to each other, those who wait take turns; who does not slow down will not
        yield either.
        """
        if own.in_order:
            return self._approaches.goes_first(name, foe)
        return conflict.in_turn and self._approaches.waited_longer(name, foe)

    def _ways_of(self, name: str, lane: str, route: str) -> tuple[tuple[str, float], ...]:
        """Return the ways through junctions that a vehicle on a lane takes next.

        Each way is named by its last internal lane and given with its distance from the beginning of the
        present lane, which is negative when the vehicle is on the way's second part.
        """
        known = self._ways.get(name)
        if known is None or known[0] != (lane, route):
            known = self._ways[name] = ((lane, route), tuple(self._next_ways(name, lane)))
        return known[1]

    def _next_ways(self, name: str, lane: str) -> list[tuple[str, float]]:
        network = self._network
        ways: list[tuple[str, float]] = []
        if lane not in network.lanes:
            return ways
        vehicle = self._sumo.vehicle
        route: Sequence[str] = vehicle.getRoute(name)
        index = max(vehicle.getRouteIndex(name), 0)
        gone = 0.0
        here = network.lanes[lane]
        through = network.through.get(lane)
        if through is not None:
            before = sum(network.lanes[part].length for part in through.via[: through.via.index(lane)])
            ways.append((through.via[-1], -before))
            gone = sum(network.lanes[part].length for part in through.via) - before
            here = network.lanes[through.target]
            index += 1  # inside a junction, the route index is still that of the edge before it
        for following in route[index + 1 :]:
            gone += here.length
            onward = self._onward(here.edge, here.index, following)
            if onward is None or gone > self._farthest + here.length:
                break
            if onward.via:
                ways.append((onward.via[-1], gone))
                gone += sum(network.lanes[part].length for part in onward.via)
            here = network.lanes[onward.target]
        return ways

    def _onward(self, edge: str, index: int, following: str) -> Connection | None:
        """Return the connection to the next edge, from this lane or the nearest one that has it."""
        network = self._network
        found = [
            connection
            for lane in network.edges.get(edge, ())
            for connection in network.connections.get(lane, ())
            if network.lanes[connection.target].edge == following
        ]
        return min(found, key=lambda c: abs(network.lanes[c.source].index - index), default=None)

    def _conflicts_of(self, junction: PathJunction) -> Mapping[str, Sequence[Conflict]]:
        """Return where other ways meet one through a junction, by the last internal lane of the other way."""
        connection, drawn = junction.connection, junction.drawn
        key = connection.via[-1], b"" if drawn is None else drawn.points.tobytes()
        if key not in self._conflicts:
            network = self._network
            foes = network.foes(connection) if drawn is None else network.others_in_junction(connection)
            own = self._sampled(connection) if drawn is None else drawn.points
            by_way: dict[str, list[Conflict]] = {}
            for foe, yields in foes:
                in_turn = network.take_turns(connection, foe)
                conflict = self._conflict(own, drawn, foe, must_yield=yields, in_turn=in_turn)
                if conflict is not None:
                    by_way.setdefault(foe.via[-1], []).append(conflict)
            self._conflicts[key] = by_way
        return self._conflicts[key]

    def _conflict(
        self, own: FloatArray, drawn: DrawnWay | None, foe: Connection, *, must_yield: bool, in_turn: bool
    ) -> Conflict | None:
        other, begins = self._sampled(foe), 0.0
        close = scipy.spatial.distance.cdist(own, other) < CLEARANCE
        own_hits = np.flatnonzero(close.any(axis=1))
        reached = WAY_SPACING * own_hits
        if drawn is not None:
            # The front bumper of a car that turns round is far beside the way of its rear axle.
            close_ahead = scipy.spatial.distance.cdist(drawn.ahead, other) < CLEARANCE
            ahead_hits = np.flatnonzero(close_ahead.any(axis=1))
            reached = np.append(reached, WAY_SPACING * ahead_hits + drawn.front)
            own_hits, close, begins = np.append(own_hits, ahead_hits), close | close_ahead, drawn.begins
        if not close.any():
            return None
        other_hits = np.flatnonzero(close.any(axis=0))
        return Conflict(
            foe,
            must_yield,
            in_turn,
            begins + float(reached.min()),
            begins + WAY_SPACING * float(own_hits.max()),
            WAY_SPACING * float(other_hits[0]),
            WAY_SPACING * float(other_hits[-1]),
            foe_range(self._network.lanes[foe.source].speed),
        )

    def _sampled(self, connection: Connection) -> FloatArray:
        shapes = [self._network.lanes[name].shape for name in connection.via]
        line = np.concatenate(shapes)
        stations = arc_lengths(line)
        grid = np.arange(0.0, stations[-1] + WAY_SPACING, WAY_SPACING)
        return np.column_stack([np.interp(grid, stations, line[:, axis]) for axis in (0, 1)])


def _stopped(connection: Connection, lights: Lights) -> bool:
    """Return whether a red light stops the vehicles on that way."""
    letter = lights.letter(connection.signal, connection.signal_index)
    return letter != "" and letter in "ru"
