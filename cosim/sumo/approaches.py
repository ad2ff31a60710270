"""Vehicles on their way to a junction: who is held up by whom, and who came to it first where that counts."""

from __future__ import annotations

import math
from collections.abc import Sequence

from cosim.sumo.network import Connection, Network
from cosim.sumo.present import forget_absent
from cosim.sumo.road_users import Cars

AT_THE_LINE = 6.0
"""A slow vehicle within this distance of its line has come to the junction [m]."""
SLOW = 2.0
"""Below this speed, a vehicle counts as slow [m/s]."""


class Approaches:
    """What is known of the vehicles before junctions.

    It remembers when each came to an all-way stop, or slowed down before another junction where they take
    turns.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._in_order = frozenset(
            lane
            for lane, onward in network.connections.items()
            if any(connection.in_order or _takes_turns(network, connection) for connection in onward)
        )
        self._cars: Cars | None = None
        self._paces: dict[int, float] = {}
        self._came: dict[str, tuple[str, float]] = {}
        """By vehicle: the lane at whose end it stopped, and when [s]; −inf once it is in the junction."""

    def begin(self, cars: Cars, time: float) -> None:
        """Begin an instant [s]: note which vehicles have come to their junction."""
        self._cars, self._paces = cars, {}
        if not self._in_order:
            return
        forget_absent(self._came, cars.names)
        for row, lane in enumerate(cars.lane):
            name = cars.names[row]
            known = self._came.get(name)
            if known is not None and known[0] != lane:
                if lane in self._network.through:
                    self._came[name] = (lane, -math.inf)
                    continue
                del self._came[name]
                known = None
            if known is None and lane in self._in_order and cars.speed[row] < SLOW:
                left = self._network.lanes[lane].length - float(cars.lane_position[row])
                if left <= AT_THE_LINE:
                    self._came[name] = (lane, time)

    def pace(self, row: int) -> float:
        """Return how fast a vehicle advances: no faster than the vehicles ahead of it in its lane [m/s]."""
        if not self._paces and self._cars is not None:
            self._paces = _paces(self._cars)
        return self._paces[row]

    def goes_first(self, one: str, other: str) -> bool:
        """Return whether ``one`` came to an all-way stop before ``other``, or is already in the junction."""
        return one in self._came and self._order(one) < self._order(other)

    def waited_longer(self, one: str, other: str) -> bool:
        """Return whether both wait at a junction, and ``one`` came first or is already in it."""
        return other in self._came and self.goes_first(one, other)

    def _order(self, name: str) -> tuple[float, str]:
        known = self._came.get(name)
        return (known[1] if known is not None else math.inf, name)


def _takes_turns(network: Network, connection: Connection) -> bool:
    return any(network.take_turns(connection, foe) for foe, yields in network.foes(connection) if yields)


def _paces(cars: Cars) -> dict[int, float]:
    """Return, by row, the lowest speed of a vehicle and of the vehicles ahead of it in its lane [m/s]."""
    rows: Sequence[int] = sorted(
        range(len(cars.names)), key=lambda row: (cars.lane[row], -float(cars.lane_position[row]))
    )
    paces: dict[int, float] = {}
    lane, slowest = "", math.inf
    for row in rows:
        if cars.lane[row] != lane:
            lane, slowest = cars.lane[row], math.inf
        slowest = min(slowest, float(cars.speed[row]))
        paces[row] = slowest
    return paces
