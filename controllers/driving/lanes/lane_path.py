"""Paths across the road that remain valid when the reference lane changes.

They are described relative to one lane, over the distance travelled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from controllers.arrays import FloatArray
from controllers.driving.lane_keeping import Place
from controllers.interface import EgoState, Perception

LEAST_ADVANCE = 0.2
"""Points of a path that are closer than this along the lane to the point before are left out [m]."""


class Shape(Protocol):
    """Offsets from a lane's centre line."""

    @property
    def length(self) -> float:
        """Along coordinate where it ends [m]; beyond it, the path goes straight on."""
        ...

    def at(self, along: float) -> Place:
        """Return the place at the distance ``along`` from the path's beginning [m]."""
        ...


class SplineShape:
    """A smooth curve through points, with given directions at both ends.

    Parameters
    ----------
    along, across : points, at least two, along ascending [m]
    begins, ends : slopes at the ends
    """

    def __init__(self, along: FloatArray, across: FloatArray, begins: float, ends: float) -> None:
        spline = CubicSpline(along, across, bc_type=((1, np.array(begins)), (1, np.array(ends))))
        self._curves = [spline, spline.derivative(1), spline.derivative(2)]
        self._begins, self._ends = float(along[0]), float(along[-1])
        self._slope_after = ends

    @property
    def length(self) -> float:
        """Along coordinate of the last point [m]."""
        return self._ends

    def at(self, along: float) -> Place:
        """Return the place; beyond the last point the curve goes straight on."""
        if along > self._ends:
            last = float(self._curves[0](self._ends))
            return Place(last + self._slope_after * (along - self._ends), self._slope_after, 0.0)
        place = max(along, self._begins)
        across, slope, bend = (float(curve(place)) for curve in self._curves)
        return Place(across, slope, bend)


def through(along: FloatArray, across: FloatArray, begins: float, ends: float) -> SplineShape | None:
    """Return the curve through those points that advance along the lane; ``None`` if fewer than two do.

    Parameters
    ----------
    along, across : points, of which the first is always kept [m]
    begins, ends : slopes at the ends
    """
    kept = [0]
    for i in range(1, len(along)):
        if along[i] - along[kept[-1]] >= LEAST_ADVANCE:
            kept.append(i)
    if len(kept) < 2:
        return None
    return SplineShape(along[kept], across[kept], begins, ends)


@dataclass(frozen=True, slots=True)
class LanePath:
    """A shape beside the centre line of one lane that begins at some reading of the odometer."""

    lane: int
    """``Lane.number``."""
    begun: float
    """Distance travelled when the path began [m]."""
    shape: Shape

    def seen(self, perception: Perception, travelled: float) -> Course | None:
        """Return the path as a course in the present route frame; ``None`` if the lane exists no longer."""
        lane = perception.road.lane(self.lane)
        if lane is None:
            return None
        return Course(self.shape, travelled - self.begun, lane.offset)

    def left(self, travelled: float) -> float:
        """Return the distance until the path ends; negative after that [m]."""
        return self.begun + self.shape.length - travelled


@dataclass(frozen=True, slots=True)
class Course:
    """A shape placed in one route frame; see :class:`controllers.driving.lane_keeping.Course`."""

    shape: Shape
    passed: float
    """Along coordinate of the shape at the origin of the route frame [m]."""
    offset: float
    """Offset of the lane that the shape is relative to [m]."""

    def at(self, along: float) -> Place:
        """Return the place of the shape at an along coordinate [m]."""
        place = self.shape.at(self.passed + along)
        return Place(self.offset + place.across, place.slope, place.bend)


class Odometer:
    """Distance travelled along the lane, computed from the speeds of one ego."""

    def __init__(self) -> None:
        self.travelled = 0.0
        self._before: EgoState | None = None

    def look(self, ego: EgoState) -> float:
        """Return the distance travelled until now [m]; a second look at the same instant adds nothing."""
        before, self._before = self._before, ego
        if before is not None and ego.time > before.time:
            mean = 0.5 * (before.speed + ego.speed)
            turned = 0.5 * (before.heading_error + ego.heading_error)
            self.travelled += mean * math.cos(turned) * (ego.time - before.time)
        return self.travelled


def told(course: Course, along: FloatArray) -> FloatArray:
    """Return the across coordinates of a course at along coordinates, same shape [m]."""
    return np.array([course.at(float(place)).across for place in along])
