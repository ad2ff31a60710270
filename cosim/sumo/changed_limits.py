"""Speed limits that change during a run: those of variable speed signs and of calibrators."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cosim.sumo.network import Network

ROUNDING = 0.005
"""Differences up to this are rounding: a network gives its limits to the hundredth [m/s]."""


class ChangedLimits:
    """Reads the limits of the lanes on which a sign or a calibrator may change them.

    Parameters
    ----------
    sumo : module or connection
    network
    """

    def __init__(self, sumo: Any, network: Network) -> None:
        self._limit = sumo.lane.getMaxSpeed
        lanes = network.lanes
        self._given = {name: lanes[name].speed for name in _concerned(sumo, network) if name in lanes}
        self.now: Mapping[str, float] = {}
        """Limits after the last step that differ from those of the network, by lane [m/s]."""

    def read(self) -> None:
        """Read the limits after a step."""
        if self._given:
            limits = {name: self._limit(name) for name in self._given}
            self.now = {
                name: limit for name, limit in limits.items() if abs(limit - self._given[name]) > ROUNDING
            }


def _concerned(sumo: Any, network: Network) -> Iterator[str]:
    """Yield the lanes whose limit a sign or a calibrator may change."""
    signs, calibrators = sumo.variablespeedsign, sumo.calibrator
    for sign in signs.getIDList():
        yield from signs.getLanes(sign)
    for calibrator in calibrators.getIDList():
        yield calibrators.getLaneID(calibrator)
        yield from network.edges.get(calibrators.getEdgeID(calibrator), ())
