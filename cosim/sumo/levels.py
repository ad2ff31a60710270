"""Roads that lead over or under each other.

SUMO's ways meet only in junctions, and its coordinates are flat. Where two edges cross without a common
junction, one is a bridge over the other. Road users on one are not in the way of those on the other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from shapely import STRtree, get_parts
from shapely.geometry import LineString, Point

from cosim.arrays import IntArray
from cosim.sumo.driven_ego import DrivenEgo
from cosim.sumo.network import Network
from cosim.sumo.sight import sight
from cosim.sumo.surroundings import Surroundings

BEHIND = 30.0
"""The ego's way begins this far behind it [m]."""

AT_AN_END = 5.0
"""Edges that cross nearer than this to an end of one of them are a badly drawn junction [m]."""
LEAST_ANGLE = np.radians(20.0)
"""Edges that cross at a smaller angle lie beside each other [rad]."""
NOBODY: frozenset[str] = frozenset()


class Levels:
    """Hides from each ego the road users above or below its way.

    Parameters
    ----------
    network
    """

    def __init__(self, network: Network) -> None:
        self._lanes = network.lanes
        self._ahead = sight(network).vehicles
        self.crossed = other_levels(network)
        """By edge: the edges that lead over or under it."""

    def met(self, surroundings: Surroundings, egos: Collection[DrivenEgo]) -> Surroundings:
        """Return the surroundings without the road users near each ego that it cannot meet."""
        if not self.crossed:
            return surroundings
        persons, cars = dict(surroundings.persons_near), dict(surroundings.cars_near)
        edges_of_cars = self._edges(surroundings.cars.lane)
        for ego in egos:
            own = {piece.lane.edge for piece in ego.track.path.between(*self._view(ego))}
            apart = NOBODY.union(*(self.crossed.get(edge, NOBODY) for edge in own)) - own
            if apart:
                persons[ego.name] = _on_others(persons[ego.name], surroundings.persons.edge, apart)
                cars[ego.name] = _on_others(cars[ego.name], edges_of_cars, apart)
        return replace(surroundings, persons_near=persons, cars_near=cars)

    def _edges(self, lanes: Sequence[str]) -> list[str]:
        return [self._lanes[lane].edge if lane in self._lanes else "" for lane in lanes]

    def _view(self, ego: DrivenEgo) -> tuple[float, float]:
        return ego.track.along - BEHIND, ego.track.along + self._ahead


def _on_others(rows: IntArray, edges: Sequence[str], apart: Collection[str]) -> IntArray:
    return np.array([row for row in rows.tolist() if edges[row] not in apart], dtype=np.int64)


def other_levels(network: Network) -> Mapping[str, frozenset[str]]:
    """Return for each edge those that lead over or under it; edges without any are left out.

    Edges inside junctions are included, and so are crossings.
    """
    lines = [
        *((lane.edge, LineString(lane.shape)) for lane in network.lanes.values()),
        *((crossing.name, LineString(crossing.axis)) for crossing in network.crossings.values()),
    ]
    if not lines:
        return {}
    shapes = [line for _, line in lines]
    found: defaultdict[str, set[str]] = defaultdict(set)
    pairs = STRtree(shapes).query(shapes, predicate="crosses").T
    for i, j in pairs[pairs[:, 0] < pairs[:, 1]].tolist():
        (one, line), (other, line_of_other) = lines[i], lines[j]
        if other in found[one] or network.junctions[one] & network.junctions[other]:
            continue
        places = [place for place in get_parts(line.intersection(line_of_other)) if isinstance(place, Point)]
        if any(_is_a_bridge(place, line, line_of_other) for place in places):
            found[one].add(other)
            found[other].add(one)
    return {edge: frozenset(others) for edge, others in found.items() if others}


def _is_a_bridge(place: Point, *lines: LineString) -> bool:
    stations = [line.project(place) for line in lines]
    if any(not AT_AN_END < at < line.length - AT_AN_END for at, line in zip(stations, lines, strict=True)):
        return False
    turns = [_direction(line, at) for at, line in zip(stations, lines, strict=True)]
    # Lines have no direction: 170 degrees is the same as 10.
    angle = abs((turns[0] - turns[1] + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
    return bool(angle > LEAST_ANGLE)


def _direction(line: LineString, at: float) -> float:
    (x, y), (to_x, to_y) = line.interpolate(at - 0.5).coords[0], line.interpolate(at + 0.5).coords[0]
    return float(np.arctan2(to_y - y, to_x - x))
