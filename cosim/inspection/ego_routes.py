"""Suggests up to five routes on which an ego meets crossings, the one with the most crossings first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from itertools import pairwise

from controllers.interface import CrossingKind
from cosim.inspection.demand import Demand, Way
from cosim.inspection.ways import CAR, Movement, Ways
from cosim.sumo.network import TURNAROUND, NetCrossing
from cosim.sumo.quickest import route_to

MOST = 5
"""Largest number of routes that are suggested."""
REACH_M = 1000.0
"""Routes extend this far before and behind the crossing for which they are made, where possible [m]."""
MOST_ORIGINS = 300
"""Largest number of edges from which routes of the demand are searched."""
_PREFERENCE = {CrossingKind.ZEBRA: 0, CrossingKind.UNMARKED: 1, CrossingKind.SIGNAL: 2}


@dataclass(frozen=True, slots=True)
class EgoRoute:
    """A route for an ego, and the crossings on it in driving order."""

    edges: tuple[str, ...]
    crossings: tuple[str, ...]
    length_m: float


@dataclass(frozen=True, slots=True)
class Passing:
    """Expected numbers of cars of the demand, and of those that drive over a crossing."""

    cars: float
    """Cars whose route is known."""
    passing: float
    impossible: float = 0.0
    """Vehicles whose edges do not exist, or do not lead from one to the next."""


def suggest(ways: Ways, most: int = MOST) -> list[EgoRoute]:
    """Return routes over crossings; each is made for a crossing that the routes made before it do not cover.

    Routes are made for zebras first, then for crossings without priority, then for those with signals; within
    a kind, those over the most lanes come first.
    """
    routes: list[EgoRoute] = []
    covered: set[str] = set()
    for crossing in sorted(ways.network.crossings.values(), key=lambda one: _rank(ways, one)):
        if len(routes) == most:
            break
        if crossing.name in covered:
            continue
        movement = _best_movement(ways, crossing)
        if movement is None:
            continue
        edges = _route_over(ways, movement)
        passed = tuple(one.name for one in ways.crossings_on(edges))
        covered.update(passed)
        routes.append(EgoRoute(edges, passed, sum(map(ways.length, edges))))
    return sorted(routes, key=lambda route: -len(route.crossings))


def passing(ways: Ways, demand: Demand) -> Passing:
    """Return how many cars of the demand drive over a crossing, on the fastest way between given edges."""
    cars = over = impossible = 0.0
    trees: dict[str, Mapping[str, str]] = {}
    for way, count in sorted(demand.ways.items()):
        given = way.edges
        if way.whole and not _connected(ways, way):
            impossible += count
            continue
        if way.kind != CAR:
            continue
        if given[0] not in trees and len(trees) == MOST_ORIGINS:
            continue
        route = _filled(ways, given, trees)
        if route is None:
            impossible += count
            continue
        cars += count
        over += count * bool(ways.crossings_on(route))
    return Passing(cars, over, impossible)


def _connected(ways: Ways, way: Way) -> bool:
    """Return whether all edges exist, and each leads to the next one for vehicles of that class."""
    network = ways.network
    if any(edge not in network.edges for edge in way.edges):
        return False
    return all(
        any(
            network.follow(network.edges[source][index], target, way.kind)
            for index in network.allowed_lanes(source, way.kind)
        )
        for source, target in pairwise(way.edges)
    )


def _filled(
    ways: Ways, given: tuple[str, ...], trees: dict[str, Mapping[str, str]]
) -> tuple[str, ...] | None:
    """Return a route with the edges between the given ones filled in; ``None`` if there is no such route."""
    if any(edge not in ways.network.edges for edge in given):
        return None
    route = given[:1]
    for source, target in pairwise(given):
        if any(movement.target == target for movement in ways.onward[source]):
            route = (*route, target)
            continue
        if source not in trees:
            trees[source] = ways.fastest(source)
        part = route_to(target, trees[source])
        if part[0] != source:
            return None
        route = (*route, *part[1:])
    return route


def _rank(ways: Ways, crossing: NetCrossing) -> tuple[int, int, str]:
    return _PREFERENCE[crossing.kind], -lanes_crossed(ways, crossing), crossing.name


def lanes_crossed(ways: Ways, crossing: NetCrossing) -> int:
    """Return how many lanes for passenger cars a crossing spans."""
    return len(ways.network.lanes_over(crossing, CAR))


def _best_movement(ways: Ways, crossing: NetCrossing) -> Movement | None:
    """Return the best movement over a crossing: straight on if possible, with the most lanes."""
    near = [
        movement
        for edge in sorted(crossing.edges)
        for movement in (*ways.onward[edge], *ways.backward[edge])
        if movement.direction != TURNAROUND and crossing in ways.crossed(movement)
    ]
    return min(near, key=lambda one: _goodness(ways, one, one.target), default=None)


def _route_over(ways: Ways, middle: Movement) -> tuple[str, ...]:
    """Return a route with a movement in its middle, which goes through no junction twice."""
    edges = [middle.source, middle.target]
    passed = {middle.junction}
    length = ways.length(middle.target)
    while length < REACH_M:
        onward = [one for one in _possible(ways.onward[edges[-1]], passed) if one.target not in edges]
        if not onward:
            break
        best = min(onward, key=lambda one: _goodness(ways, one, one.target))
        edges.append(best.target)
        passed.add(best.junction)
        length += ways.length(best.target)
    length = ways.length(middle.source)
    while length < REACH_M:
        backward = [one for one in _possible(ways.backward[edges[0]], passed) if one.source not in edges]
        if not backward:
            break
        best = min(backward, key=lambda one: _goodness(ways, one, one.source))
        edges.insert(0, best.source)
        passed.add(best.junction)
        length += ways.length(best.source)
    return tuple(edges)


def _possible(movements: Iterable[Movement], passed: Set[str]) -> list[Movement]:
    return [one for one in movements if one.direction != TURNAROUND and one.junction not in passed]


def _goodness(ways: Ways, movement: Movement, further: str) -> tuple[bool, int, str]:
    lanes = len(ways.network.allowed_lanes(further, CAR))
    return movement.direction != "s", -lanes, further
