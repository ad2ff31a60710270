"""The shape of a lane as SUMO draws it, and where points are along and across it."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise

SHORTEST_DIRECTION = 0.3
"""Shapes shorter than this have no direction [m]."""
ROUNDED = 0.005
"""Largest rounding error of lengths and coordinates in a network [m]."""


@dataclass(frozen=True, slots=True)
class Place:
    """A point seen from a lane."""

    along: float
    """Distance along the lane's shape; negative before it, greater than its length beyond it [m]."""
    across: float
    """Distance from the shape, left positive [m]."""


@dataclass(frozen=True, slots=True)
class LaneShape:
    """A lane as SUMO draws it, with the length that SUMO counts."""

    name: str
    edge: str
    index: int
    width: float
    length: float
    """Length by which SUMO counts lane positions [m]; a network may give one other than the shape's."""
    points: tuple[tuple[float, float], ...]
    stations: tuple[float, ...]
    """Distance along the shape to each point [m]."""
    positions: tuple[float, ...] = ()
    """SUMO's lane position of each point [m]; empty where it is proportional to the distance.

    It is not proportional on a lane with a slope: SUMO counts along the road, but gives the shape as seen
    from above.
    """

    @property
    def shape_length(self) -> float:
        """Length of the shape [m]."""
        return self.stations[-1]

    @property
    def scale(self) -> float:
        """Counted length over drawn length."""
        return self.length / self.stations[-1] if self.stations[-1] > 0.0 else 1.0

    def position(self, along: float) -> float:
        """Return SUMO's lane position [m] of a distance along the shape [m]."""
        if not self.positions:
            return along * self.scale
        number = min(max(bisect_right(self.stations, along) - 1, 0), len(self.points) - 2)
        drawn = self.stations[number + 1] - self.stations[number]
        counted = self.positions[number + 1] - self.positions[number]
        return self.positions[number] + (along - self.stations[number]) * counted / (drawn or 1.0)

    @property
    def no_direction(self) -> bool:
        """Whether the shape is too short to have a direction: its coordinates are rounded to centimetres."""
        return self.stations[-1] < SHORTEST_DIRECTION

    @property
    def internal(self) -> bool:
        """Whether the lane is inside a junction."""
        return self.edge.startswith(":")

    def place(self, x: float, y: float) -> Place:
        """Return where a point [m] is along and across the lane.

        The first and the last piece of the shape are extended, so that a point beyond an end has its true
        distance beyond it.
        """
        if self.no_direction:
            # Where two edges meet without a gap, SUMO draws the lane between them as a point: it is passed.
            away = math.dist(self.points[0], (x, y))
            return Place(away, away if self.shape_length == 0.0 else 0.0)
        best = math.inf
        found = Place(0.0, 0.0)
        last = len(self.points) - 2
        for number, ((x0, y0), (x1, y1)) in enumerate(pairwise(self.points)):
            east, north = x1 - x0, y1 - y0
            piece = math.hypot(east, north)
            if piece == 0.0:
                continue
            forward = ((x - x0) * east + (y - y0) * north) / piece
            sideways = ((y - y0) * east - (x - x0) * north) / piece
            low = -math.inf if number == 0 else 0.0
            high = math.inf if number == last else piece
            inside = min(max(forward, low), high)
            distance = math.hypot(forward - inside, sideways)
            if distance < best:
                best = distance
                across = math.copysign(distance, sideways)
                found = Place(self.stations[number] + inside, across)
        return found

    def heading(self, x: float, y: float) -> float:
        """Return the direction of the shape [rad] where it is nearest to a point [m]."""
        number = bisect_right(self.stations, self.place(x, y).along) - 1
        number = min(max(number, 0), len(self.points) - 2)
        (x0, y0), (x1, y1) = self.points[number], self.points[number + 1]
        return math.atan2(y1 - y0, x1 - x0)

    def point(self, along: float, across: float) -> tuple[float, float]:
        """Return the point [m] at this place; the inverse of `place` where the lane is straight."""
        number = min(max(bisect_right(self.stations, along) - 1, 0), len(self.points) - 2)
        (x0, y0), (x1, y1) = self.points[number], self.points[number + 1]
        piece = math.hypot(x1 - x0, y1 - y0) or 1.0
        east, north = (x1 - x0) / piece, (y1 - y0) / piece
        forward = along - self.stations[number]
        return x0 + forward * east - across * north, y0 + forward * north + across * east

    def drawn_off(self, place: Place, x: float, y: float) -> float:
        """Return how far from a point [m] SUMO may put a vehicle that is given the point's place [m].

        SUMO puts no vehicle in the wedge outside a corner of the shape, and next to the corner, rounding
        decides on which side of the wedge the vehicle is.
        """
        around = (place.along - ROUNDED, place.along + ROUNDED)
        return max(math.dist(self.point(along, place.across), (x, y)) for along in around) - ROUNDED
