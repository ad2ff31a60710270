"""Ways of cars through a network, and the crossings on them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from cosim.sumo.network import Connection, NetCrossing, Network, junction_of
from cosim.sumo.quickest import quickest

CAR = "passenger"


@dataclass(frozen=True, slots=True)
class Movement:
    """One way through a junction."""

    source: str
    target: str
    junction: str
    direction: str
    """Direction as given by SUMO: s, l, r, t and so on."""


class Ways:
    """The movements of passenger cars in a network.

    A car drives over a crossing if it goes through the crossing's junction from or to an edge that the
    crossing crosses.
    """

    def __init__(self, network: Network) -> None:
        self.network = network
        self.onward: defaultdict[str, list[Movement]] = defaultdict(list)
        self.backward: defaultdict[str, list[Movement]] = defaultdict(list)
        self._crossings: defaultdict[str, list[NetCrossing]] = defaultdict(list)
        for crossing in network.crossings.values():
            self._crossings[crossing_junction(crossing.name)].append(crossing)
        for movement in _movements(network):
            self.onward[movement.source].append(movement)
            self.backward[movement.target].append(movement)

    def seconds(self, edge: str) -> float:
        """Return the shortest time in which a car passes an edge [s]."""
        lane = self.network.lanes[self.network.edges[edge][-1]]
        return lane.length / max(lane.speed, 0.1)

    def length(self, edge: str) -> float:
        """Return the length of an edge [m]."""
        return self.network.lanes[self.network.edges[edge][0]].length

    def crossed(self, movement: Movement) -> list[NetCrossing]:
        """Return the crossings that a movement goes over."""
        ends = {movement.source, movement.target}
        return [one for one in self._crossings[movement.junction] if one.edges & ends]

    def crossings_on(self, edges: Sequence[str]) -> list[NetCrossing]:
        """Return the crossings on a route, in driving order."""
        found: dict[str, NetCrossing] = {}
        for source, target in pairwise(edges):
            for movement in self.onward[source]:
                if movement.target == target:
                    found |= {one.name: one for one in self.crossed(movement)}
        return list(found.values())

    def fastest(self, origin: str) -> dict[str, str]:
        """Return, for every edge reachable from ``origin``, the edge before it on the fastest route."""
        return quickest(origin, lambda edge: (one.target for one in self.onward[edge]), self.seconds)


def crossing_junction(name: str) -> str:
    """Return the junction of a crossing.

    >>> crossing_junction(":main_street_c0")
    'main_street'
    """
    return name[1:].rpartition("_c")[0]


def _movements(network: Network) -> list[Movement]:
    found: dict[Movement, None] = {}
    for edge in network.roads:
        for index in network.allowed_lanes(edge, CAR):
            for one in network.connections.get(network.edges[edge][index], ()):
                if network.passable(one, CAR):
                    target = network.lanes[one.target].edge
                    found[Movement(edge, target, _junction(network, edge, one), one.direction)] = None
    return list(found)


def _junction(network: Network, edge: str, connection: Connection) -> str:
    """Return the junction through which a connection leads; the network may lack internal lanes."""
    if connection.via:
        return junction_of(connection.via[0])
    target = network.lanes[connection.target].edge
    return min(
        network.junctions.get(edge, frozenset()) & network.junctions.get(target, frozenset()), default=""
    )
