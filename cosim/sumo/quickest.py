"""Quickest routes on empty roads, from edge to edge."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable, Mapping


def quickest(
    origin: str, onward: Callable[[str], Iterable[str]], seconds: Callable[[str], float]
) -> dict[str, str]:
    """Return, for every edge that can be reached from ``origin``, the edge before it on the quickest route.

    SUMO's own ``findRoute`` is not used: if it is called while egos are driven, libsumo 1.28 crashes later.

    Parameters
    ----------
    origin : edge at which routes begin
    onward : returns the edges that an edge leads to
    seconds : returns how long an edge takes [s]
    """
    best = {origin: 0.0}
    before: dict[str, str] = {}
    queue = [(0.0, origin)]
    while queue:
        time, edge = heapq.heappop(queue)
        if time > best[edge]:
            continue
        for target in onward(edge):
            arrival = time + seconds(target)
            if arrival < best.get(target, math.inf):
                best[target] = arrival
                before[target] = edge
                heapq.heappush(queue, (arrival, target))
    return before


def route_to(target: str, before: Mapping[str, str]) -> tuple[str, ...]:
    """Return the route that ends at an edge, or only the edge if no route leads to it.

    >>> route_to("c", {"b": "a", "c": "b"})
    ('a', 'b', 'c')
    """
    edges = [target]
    while edges[-1] in before:
        edges.append(before[edges[-1]])
    return tuple(reversed(edges))
