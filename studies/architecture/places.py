"""The places of spots in rows whose order is fixed: no overlap, and arrows as straight as they can be.

Spots that an unbranched chain of arrows connects stand exactly below each other and move as one: a column.
Columns move to the mean place of the spots that they are connected with, as far as their neighbours in the
rows let them; so do clusters of columns that touch. The sum of the squared sideways distances of all arrows
decreases with every move.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import TypeVar

SWEEPS = 300
"""How often every column is moved; afterwards they move by less than a pixel."""
TOUCHING = 0.5
"""Columns with less free width between them touch [px]."""

Spot = TypeVar("Spot", bound=Hashable)
Segments = Sequence[tuple[Spot, Spot]]


def place(
    rows: Sequence[Sequence[Spot]], segments: Segments[Spot], sizes: Mapping[Spot, float], gap: float
) -> dict[Spot, float]:
    """Return the centres of all spots [px], given their widths and the free width between them [px]."""
    spots = [spot for row in rows for spot in row]
    for column_of in (_columns(spots, segments), {spot: number for number, spot in enumerate(spots)}):
        room: dict[tuple[int, int], float] = {}
        for one, two in (pair for row in rows for pair in pairwise(row)):
            columns = column_of[one], column_of[two]
            room[columns] = max(room.get(columns, 0.0), (sizes[one] + sizes[two]) / 2 + gap)
        places = _leftmost(set(column_of.values()), room)
        if places is not None:
            break
    assert places is not None  # columns of one spot are in the order of their rows
    pulls = [(column_of[start], column_of[end]) for start, end in segments]
    for _ in range(SWEEPS):
        for column in sorted(places):
            _move({column}, places, room, pulls)
        for cluster in _clusters(places, room):
            _move(cluster, places, room, pulls)
    return {spot: places[column_of[spot]] for spot in spots}


def _columns(spots: Sequence[Spot], segments: Segments[Spot]) -> dict[Spot, int]:
    """Return the number of each spot's column."""
    starts, ends = Counter(start for start, _ in segments), Counter(end for _, end in segments)
    column_of = {spot: number for number, spot in enumerate(spots)}
    for start, end in sorted(segments, key=lambda segment: spots.index(segment[0])):
        if starts[start] == ends[end] == 1:
            column_of[end] = column_of[start]
    return column_of


def _leftmost(columns: Iterable[int], room: Mapping[tuple[int, int], float]) -> dict[int, float] | None:
    """Return the places furthest to the left, or nothing if columns would have to change sides."""
    places = dict.fromkeys(columns, 0.0)
    for _ in range(len(places) + 1):
        before = dict(places)
        for (one, two), distance in room.items():
            places[two] = max(places[two], places[one] + distance)
        if places == before:
            return places
    return None


def _clusters(places: Mapping[int, float], room: Mapping[tuple[int, int], float]) -> list[set[int]]:
    """Return the sets of columns that touch, directly or through others."""
    clusters = {column: {column} for column in places}
    for (one, two), distance in room.items():
        if places[two] - places[one] < distance + TOUCHING and clusters[one] is not clusters[two]:
            clusters[one] |= clusters[two]
            for column in clusters[two]:
                clusters[column] = clusters[one]
    return [cluster for column, cluster in sorted(clusters.items()) if column == min(cluster)]


def _move(
    moved: set[int],
    places: dict[int, float],
    room: Mapping[tuple[int, int], float],
    pulls: Sequence[tuple[int, int]],
) -> None:
    """Move columns by the mean distance to the others they are connected with, or as far as they can."""
    distances = [places[end] - places[start] for start, end in pulls if start in moved and end not in moved]
    distances += [places[start] - places[end] for start, end in pulls if end in moved and start not in moved]
    if not distances:
        return
    shift = sum(distances) / len(distances)
    for (one, two), distance in room.items():
        free = places[two] - places[one] - distance
        if one in moved and two not in moved:
            shift = min(shift, free)
        elif two in moved and one not in moved:
            shift = max(shift, -free)
    for column in moved:
        places[column] += shift
