"""The part of a network that a run needs for drawing and judging."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping

import numpy as np

from cosim.arrays import FloatArray
from cosim.step.world import CrossingFacts, MapArea
from cosim.sumo.network import NetCrossing, Network

ToDegrees = Callable[[float, float], tuple[float, float]]
"""Converts a place in the network to longitude and latitude."""

CELL = 20.0
"""Size of the cells by which the egos' places are remembered [m]."""
_CAR = "passenger"
_ON_FOOT = frozenset({"pedestrian", "wheelchair"})
REACH = 80.0
"""Lanes, crossings and walking areas nearer to a cell than this belong to the map [m]."""


def cells_of_crossings(network: Network) -> set[tuple[int, int]]:
    """Return the cells that contain crossings."""
    cells = (np.round(crossing.axis / CELL).astype(np.int64) for crossing in network.crossings.values())
    return {(int(x), int(y)) for some in cells for x, y in some}


def areas_near(
    network: Network,
    cells: Iterable[tuple[int, int]],
    to_degrees: ToDegrees,
    crossed: Mapping[str, Collection[str]],
) -> list[MapArea]:
    """Return lanes, crossings and walking areas near cells.

    Parameters
    ----------
    network
    cells : world positions divided by `CELL`, rounded
    to_degrees : called only if the network has a projection
    crossed : by edge, the edges that lead over or under it
    """
    places = CELL * np.array(sorted(cells), dtype=np.float64).reshape(-1, 2)

    def near(shape: FloatArray) -> bool:
        low, high = shape.min(axis=0) - REACH, shape.max(axis=0) + REACH
        return bool(((places >= low) & (places <= high)).all(axis=1).any())

    lanes = [
        MapArea(
            lane.name,
            "lane",
            lane.width,
            lane.shape,
            crossed=_sorted(crossed.get(lane.edge)),
            on_foot=lane.permissions.allow is not None and lane.permissions.allow <= _ON_FOOT,
        )
        for lane in network.lanes.values()
        if near(lane.shape)
    ]
    crossings = [
        MapArea(
            crossing.name,
            "crossing",
            crossing.width,
            crossing.axis,
            crossing.kind.value,
            _facts(network, crossing, to_degrees),
            _sorted(crossed.get(crossing.name)),
        )
        for crossing in network.crossings.values()
        if near(crossing.axis)
    ]
    walking_areas = [
        MapArea(area.name, "walkingarea", 0.0, area.outline)
        for area in network.walking_areas.values()
        if near(area.outline)
    ]
    return [*lanes, *crossings, *walking_areas]


def _sorted(names: Collection[str] | None) -> tuple[str, ...]:
    return tuple(sorted(names or ()))


def _facts(network: Network, crossing: NetCrossing, to_degrees: ToDegrees) -> CrossingFacts:
    lanes = network.lanes_over(crossing, _CAR)
    limit = max((lane.speed for lane in lanes), default=math.nan)
    x, y = (0.5 * (crossing.axis[0] + crossing.axis[-1])).tolist()
    place = to_degrees(x, y) if network.geographic else (math.nan, math.nan)
    return CrossingFacts(len(lanes), limit, crossing.refuge, *place)
