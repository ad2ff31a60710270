"""Walks over a crossing, from the sidewalk on one side to that on the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cosim.inspection.ego_routes import EgoRoute
from cosim.inspection.roads import is_sidewalk
from cosim.sumo.network import NetCrossing, NetLane, Network

APPROACH_M = 20.0
"""People appear this far before a crossing, and leave this far behind it [m]."""
NEAR_M = 30.0
"""Sidewalks farther than this from the end of a crossing do not lead to it [m]."""


@dataclass(frozen=True, slots=True)
class Walk:
    """A walk from a place on one sidewalk to a place on another."""

    origin: str
    """Edge on which the walk begins."""
    depart_m: float
    """Position along that edge [m]."""
    destination: str
    arrival_m: float

    def back(self) -> Walk:
        """Return the same walk in the other direction."""
        return Walk(self.destination, self.arrival_m, self.origin, self.depart_m)


def walks_over(network: Network, routes: Iterable[EgoRoute]) -> list[Walk]:
    """Return one walk for each crossing on the routes that has a sidewalk at either end."""
    names = dict.fromkeys(name for route in routes for name in route.crossings)
    sidewalks = [lane for lane in network.lanes.values() if not lane.internal and is_sidewalk(lane)]
    walks = (_walk(network.crossings[name], sidewalks) for name in names)
    return [walk for walk in walks if walk is not None]


def _walk(crossing: NetCrossing, sidewalks: list[NetLane]) -> Walk | None:
    start = _nearest(crossing.axis[0], sidewalks, "")
    if start is None:
        return None
    end = _nearest(crossing.axis[-1], sidewalks, start[0])
    return None if end is None else Walk(*start, *end)


def _nearest(point: NDArray[np.float64], sidewalks: list[NetLane], other: str) -> tuple[str, float] | None:
    """Return the edge whose sidewalk begins or ends nearest to a point, and the position to walk from."""
    best: tuple[float, str, float] | None = None
    for lane in sidewalks:
        if lane.edge == other:
            continue
        way = min(APPROACH_M, 0.5 * lane.length)
        for end, place in ((lane.shape[0], way), (lane.shape[-1], lane.length - way)):
            distance = float(np.hypot(*(end - point)))
            if distance <= NEAR_M and (best is None or (distance, lane.edge) < best[:2]):
                best = (distance, lane.edge, place)
    return None if best is None else best[1:]
