"""Where boxes on floors go, so that their arrows cross seldom and run straight:
a layered drawing after Sugiyama.

An arrow that passes floors gets a point of its own on each of them, which is placed like a narrow box.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

from studies.architecture.places import place
from studies.architecture.rooms import Box

GAP = 9.0
"""Free width between neighbours on a floor [px]."""


@dataclass(frozen=True)
class Point:
    """Where an arrow passes a floor between its two boxes."""

    start: Box
    end: Box
    floor: int


Spot = Box | Point
Floors = list[list[Spot]]
Routes = list[list[Spot]]


@dataclass(frozen=True)
class Layout:
    """Centres of boxes and points [px], the spots that each arrow visits, and the width of it all [px]."""

    centres: Mapping[Spot, float]
    routes: Routes
    width: float


def arrange(
    floors: Sequence[Sequence[Box]], arrows: Sequence[tuple[Box, Box]], widths: Mapping[Box, float]
) -> Layout:
    """Place boxes with the given widths [px] on their floors."""
    spots, routes = _with_points(floors, arrows)
    segments = [pair for route in routes for pair in pairwise(route)]
    rows = _ordered(spots, segments)
    size = {spot: widths[spot] if isinstance(spot, Box) else 0.0 for row in rows for spot in row}
    centres = place(rows, segments, size, GAP)
    left = min(centres[spot] - size[spot] / 2 for spot in centres)
    right = max(centres[spot] + size[spot] / 2 for spot in centres)
    return Layout({spot: x - left for spot, x in centres.items()}, routes, right - left)


def _with_points(floors: Sequence[Sequence[Box]], arrows: Sequence[tuple[Box, Box]]) -> tuple[Floors, Routes]:
    rows: Floors = [list(floor) for floor in floors]
    floor_of = {box: number for number, floor in enumerate(floors) for box in floor}
    routes: Routes = []
    for start, end in arrows:
        points: list[Spot] = [Point(start, end, at) for at in range(floor_of[start] + 1, floor_of[end])]
        for point in points:
            assert isinstance(point, Point)
            rows[point.floor].append(point)
        routes.append([start, *points, end])
    return rows, routes


def _ordered(rows: Floors, segments: Sequence[tuple[Spot, Spot]]) -> Floors:
    """Return the floors in the best order that exchanges of neighbours reach from two beginnings."""
    found = [_improved([row[::way] for row in rows], segments) for way in (1, -1)]
    return min(found, key=lambda rows: _badness(rows, segments))


def _improved(rows: Floors, segments: Sequence[tuple[Spot, Spot]]) -> Floors:
    rows = _by_neighbours(rows, segments)
    best = _badness(rows, segments)
    improving = True
    while improving:
        improving = False
        for row in rows:
            for one, two in combinations(range(len(row)), 2):
                row[one], row[two] = row[two], row[one]
                badness = _badness(rows, segments)
                if badness < best:
                    best, improving = badness, True
                else:
                    row[one], row[two] = row[two], row[one]
    return rows


def _by_neighbours(rows: Floors, segments: Sequence[tuple[Spot, Spot]]) -> Floors:
    """Return each floor in the order of the mean places of those connected with them on the floor above."""
    for above, row in pairwise(rows):
        at = {spot: number / max(1, len(above) - 1) for number, spot in enumerate(above)}
        means = {}
        for number, spot in enumerate(row):
            over = [at[start] for start, end in segments if end == spot]
            means[spot] = sum(over) / len(over) if over else number / max(1, len(row) - 1)
        row.sort(key=means.__getitem__)
    return rows


def _badness(rows: Floors, segments: Sequence[tuple[Spot, Spot]]) -> tuple[int, float]:
    """Return the number of crossings, and how far arrows run sideways in relative places."""
    at = {spot: (floor, number) for floor, row in enumerate(rows) for number, spot in enumerate(row)}
    middle = {spot: number - (len(rows[floor]) - 1) / 2 for spot, (floor, number) in at.items()}
    ends = [(at[start], at[end]) for start, end in segments]
    crossings = sum(
        one[0][0] == two[0][0] and (one[0][1] - two[0][1]) * (one[1][1] - two[1][1]) < 0
        for one, two in combinations(ends, 2)
    )
    return crossings, sum(abs(middle[start] - middle[end]) for start, end in segments)
