"""All ways of cars over a crossing: where they come from, their manoeuvre, and their edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.inspection.ways import Movement, Ways
from cosim.sumo.network import TURNAROUND
from cosim.sumo.network_file import read_network

MANOEUVRES = {"s": "straight", "l": "left", "L": "left", "r": "right", "R": "right"}
ONWARD_M = 30.0
"""Routes continue this far behind the crossing if the network allows it [m]."""


@dataclass(frozen=True, slots=True)
class Passage:
    """A car's way over a crossing."""

    crossing: str
    source: str
    """Edge from which the car comes to the crossing's junction."""
    target: str
    manoeuvre: str
    edges: tuple[str, ...]
    """Route, beginning with the approach."""

    @property
    def name(self) -> str:
        """Name for tables and choices."""
        return f"{self.crossing} {self.manoeuvre} from {self.source} to {self.target}"


def read_ways(net_file: Path) -> Ways:
    """Return the ways of cars through the network in a file."""
    return Ways(read_network(net_file))


def passages(ways: Ways, crossings: Sequence[str], shortest_m: float, longest_m: float) -> list[Passage]:
    """Return the passages whose approach has a fitting length, sorted by name.

    Parameters
    ----------
    ways
        Ways of cars through the network.
    crossings
        Ids of crossings; empty for all.
    shortest_m, longest_m
        Limits of the length of the approach, from the beginning of the route to the junction. A short
        approach is extended by the edges before it. If its last edge alone is too long, there is no passage.
    """
    wanted = set(crossings) or set(ways.network.crossings)
    found = []
    for movements in list(ways.onward.values()):
        for movement in movements:
            if movement.direction == TURNAROUND:
                continue
            over = [one.name for one in ways.crossed(movement) if one.name in wanted]
            edges = _route(ways, movement, shortest_m, longest_m) if over else ()
            manoeuvre = MANOEUVRES.get(movement.direction, "straight")
            if edges:
                found += [Passage(name, movement.source, movement.target, manoeuvre, edges) for name in over]
    return sorted(found, key=lambda one: one.name)


def _route(ways: Ways, movement: Movement, shortest_m: float, longest_m: float) -> tuple[str, ...]:
    """Return the edges of a passage; empty if no approach has a fitting length."""
    edges = [movement.source, movement.target]
    approach = ways.length(movement.source)
    while approach < shortest_m:
        before = _best(ways.backward[edges[0]], edges, source=True)
        if before is None or approach + ways.length(before) > longest_m:
            break
        edges.insert(0, before)
        approach += ways.length(before)
    if not shortest_m <= approach <= longest_m:
        return ()
    onward = ways.length(movement.target)
    while onward < ONWARD_M:
        after = _best(ways.onward[edges[-1]], edges, source=False)
        if after is None:
            break
        edges.append(after)
        onward += ways.length(after)
    return tuple(edges)


def _best(movements: Sequence[Movement], edges: Sequence[str], source: bool) -> str | None:
    """Return the next edge of a route, straight on if possible."""
    possible = sorted(
        (one.direction != "s", one.source if source else one.target)
        for one in movements
        if one.direction != TURNAROUND and (one.source if source else one.target) not in edges
    )
    return possible[0][1] if possible else None
