"""The part of a network that a run needs for drawing and judging."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cosim.step.world import MapArea
from cosim.sumo.network import Network

FloatArray = NDArray[np.float64]

CELL = 20.0
"""Egos' places are remembered by cells of this size [m]."""
REACH = 80.0
"""What is nearer to a cell than this belongs to the map [m]."""


def cells_of_crossings(network: Network) -> set[tuple[int, int]]:
    """Return the cells in which crossings are."""
    cells = (np.round(crossing.axis / CELL).astype(np.int64) for crossing in network.crossings.values())
    return {(int(x), int(y)) for some in cells for x, y in some}


def areas_near(network: Network, cells: Iterable[tuple[int, int]]) -> list[MapArea]:
    """Return lanes, crossings and walking areas near cells.

    Parameters
    ----------
    network
    cells : world positions divided by `CELL`, rounded
    """
    places = CELL * np.array(sorted(cells), dtype=np.float64).reshape(-1, 2)

    def near(shape: FloatArray) -> bool:
        low, high = shape.min(axis=0) - REACH, shape.max(axis=0) + REACH
        return bool(((places >= low) & (places <= high)).all(axis=1).any())

    lanes = [
        MapArea(lane.name, "lane", lane.width, lane.shape)
        for lane in network.lanes.values()
        if near(lane.shape)
    ]
    crossings = [
        MapArea(crossing.name, "crossing", crossing.width, crossing.axis, crossing.kind.value)
        for crossing in network.crossings.values()
        if near(crossing.axis)
    ]
    walking_areas = [
        MapArea(area.name, "walkingarea", 0.0, area.outline)
        for area in network.walking_areas.values()
        if near(area.outline)
    ]
    return [*lanes, *crossings, *walking_areas]
