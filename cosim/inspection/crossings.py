"""Findings on crossings and on the routes that pass them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from controllers.interface import CrossingKind
from cosim.inspection.ego_routes import EgoRoute, Passing, lanes_crossed
from cosim.inspection.finding import Finding, Level
from cosim.inspection.roads import any_sidewalk, guess_command
from cosim.inspection.ways import Ways
from cosim.sumo.network import Network

NAMES = {
    CrossingKind.ZEBRA: "zebra",
    CrossingKind.UNMARKED: "without priority",
    CrossingKind.SIGNAL: "with signals",
}
"""Names of the kinds in texts."""

Counts = dict[tuple[CrossingKind, int], int]
"""Number of crossings by kind and by lanes crossed."""


def counted(ways: Ways) -> Counts:
    """Return how many crossings there are of each kind over each number of lanes for cars."""
    found = Counter((one.kind, lanes_crossed(ways, one)) for one in ways.network.crossings.values())
    order = list(CrossingKind)
    return dict(sorted(found.items(), key=lambda item: (order.index(item[0][0]), item[0][1])))


def crossings(network: Network, counts: Counts, net_file: Path) -> Finding:
    """Report how many crossings there are of each kind."""
    kinds: Counter[CrossingKind] = Counter()
    for (kind, _), count in counts.items():
        kinds[kind] += count
    if kinds:
        parts = [f"{kinds[kind]} {NAMES[kind]}" for kind in CrossingKind if kinds[kind]]
        return Finding("crossings", Level.GOOD, ", ".join(parts))
    command = guess_command(network, net_file, sidewalks=not any_sidewalk(network))
    return Finding("crossings", Level.MISSING, "none", command)


def impossible_routes(cars: Passing | None) -> list[Finding]:
    """Report vehicles of the demand whose route is not possible."""
    if cars is None or not cars.impossible:
        return []
    count = max(1, round(cars.impossible))
    who = "vehicle of the demand has" if count == 1 else "vehicles of the demand have"
    text = f"{count:,} {who} edges that do not exist or are not connected"
    return [Finding("car routes", Level.DANGER, text + ": SUMO stops at the first one")]


def ego_routes(routes: Sequence[EgoRoute], cars: Passing | None, any_crossing: bool) -> Finding:
    """Report whether a car can drive over a crossing, and how many cars of the demand do."""
    if not routes:
        where = "no car can drive over any of the crossings" if any_crossing else "there is no crossing"
        return Finding("ego routes", Level.MISSING, where)
    text = f"{len(routes)} suggested"
    if cars is not None and cars.cars:
        text += f"; {cars.passing:,.0f} of {cars.cars:,.0f} cars of the demand drive over a crossing"
        if not cars.passing:
            return Finding("ego routes", Level.NOTE, text)
    return Finding("ego routes", Level.GOOD, text)
