"""A straight line that a pedestrian walks along, and its intersections with vehicles' ways."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import RADIUS, STANDING, RoadUser

LOOK_AHEAD = 3.0
"""Length of the walk ahead that a pedestrian announces [m]."""
SPACING = 0.5
"""Greatest distance between the points at which a line is compared with a vehicle's way [m]."""
SIDE = 0.3
"""Pedestrians do not walk past the front of a vehicle nearer than this [m]."""


@dataclass(frozen=True, slots=True)
class Meeting:
    """The place where a vehicle's way crosses a line."""

    along: float
    """Distance from the front bumper to the line; negative once the bumper has passed the line [m]."""
    enters: float
    """Distance along the line at which the disc enters the area that the body sweeps [m]."""
    middle: float
    leaves: float
    nearest: float
    """Like ``along``, at the nearest point between ``enters`` and ``leaves``: lines may be oblique [m]."""
    furthest: float

    def arrival(self, vehicle: RoadUser) -> float:
        """Return the time until the front bumper is at the line [s].

        It is 0 for a vehicle that is on the line, and inf for one that stands before it or has passed it.
        """
        if self.furthest + vehicle.length < 0.0:
            return math.inf
        if self.nearest <= RADIUS + SIDE:
            return 0.0  # the vehicle is on the line, moving or not
        return (self.nearest - RADIUS) / vehicle.speed if vehicle.speed > STANDING else math.inf

    def leaves_gap(self, vehicle: RoadUser, enters: float, gap: float) -> bool:
        """Return whether the vehicle leaves a gap for a pedestrian who will enter its swept area.

        It does if it arrives at least ``gap`` after the pedestrian enters, if it has passed by then, or if
        it stands.

        Parameters
        ----------
        vehicle : the vehicle of this meeting
        enters : time until the pedestrian enters the swept area [s]
        gap : smallest gap that the pedestrian accepts [s]
        """
        arrival = self.arrival(vehicle)
        if math.isinf(arrival) or arrival >= enters + gap:
            return True
        passed = self.furthest + vehicle.length + RADIUS
        return vehicle.speed > 0.0 and passed / vehicle.speed < enters


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line from a start to an end [m].

    >>> Line(0.0, 0.0, 0.0, 8.0).point(2.0)
    (0.0, 2.0)
    """

    x: float
    y: float
    end_x: float
    end_y: float

    @property
    def length(self) -> float:
        """Length of the line [m]."""
        return math.dist((self.x, self.y), (self.end_x, self.end_y))

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector along the line."""
        return (self.end_x - self.x) / self.length, (self.end_y - self.y) / self.length

    def point(self, way: float) -> tuple[float, float]:
        """Return the point at a distance along the line [m]."""
        east, north = self.direction
        return self.x + way * east, self.y + way * north

    def shifted(self, along: float, left: float) -> Line:
        """Return the line moved ahead along its direction and to the left of it [m]."""
        east, north = self.direction
        dx, dy = along * east - left * north, along * north + left * east
        return Line(self.x + dx, self.y + dy, self.end_x + dx, self.end_y + dy)

    def onward(self, way: float) -> FloatArray:
        """Return the points on the next metres after a distance along the line, (n, 2) [m]."""
        steps = np.arange(0.0, LOOK_AHEAD + 1e-9, 0.5)
        reached = np.minimum(way + steps, max(self.length, way))
        return np.array([self.point(float(one)) for one in reached])

    def meeting(self, vehicle: RoadUser, across: float = 0.0) -> Meeting | None:
        """Return where the line first crosses a vehicle's way; ``None`` if it does not.

        Parameters
        ----------
        vehicle : the vehicle, with its way
        across : point of the front bumper that is to meet the line, left of the middle positive [m]

        Notes
        -----
        The line is examined at points 0.5 m apart, and taken as straight in the vehicle's frame between them.
        """
        ways, places = _evenly_on(self)
        along, beside = vehicle.sees(places)
        middle = _first_zero(ways, beside - across)
        if middle is None:
            return None
        half = 0.5 * vehicle.width + RADIUS
        outside = np.abs(beside) - half
        before, after = ways <= middle, ways >= middle
        # Search from the middle backwards and forwards for where the disc is outside the swept area.
        enters = _first_zero(ways[before][::-1], outside[before][::-1])
        leaves = _first_zero(ways[after], outside[after])
        first = 0.0 if enters is None else enters
        last = self.length if leaves is None else leaves
        inner = np.interp([first, middle, last], ways, along)
        return Meeting(float(inner[1]), first, middle, last, float(inner.min()), float(inner.max()))


@lru_cache(maxsize=1024)
def _evenly_on(line: Line) -> tuple[FloatArray, FloatArray]:
    """Return evenly spaced distances along a line, and the points there, shape (n, 2) [m]."""
    ways = np.linspace(0.0, line.length, max(math.ceil(line.length / SPACING), 1) + 1)
    east, north = line.direction
    return ways, np.column_stack([line.x + ways * east, line.y + ways * north])


def _first_zero(places: FloatArray, values: FloatArray) -> float | None:
    """Return the first place at which values, linear between places, are zero; ``None`` if there is none."""
    if len(values) and values[0] == 0.0:
        return float(places[0])
    change = np.flatnonzero((values[:-1] < 0.0) != (values[1:] < 0.0))
    if not len(change):
        return None
    k = int(change[0])
    share = values[k] / (values[k] - values[k + 1])
    return float(places[k] + share * (places[k + 1] - places[k]))
