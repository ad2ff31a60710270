"""Ways from one pose to another that turn no tighter than a radius: arcs of that radius and straight lines.

L. E. Dubins, On Curves of Minimal Length with a Constraint on Average Curvature, American Journal of
Mathematics 79 (1957).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from cosim.arrays import FloatArray

Three = tuple[float, float, float]
Turns = tuple[int, int, int]

LEFT, STRAIGHT, RIGHT = 1, 0, -1
_FULL = 2.0 * math.pi
_ROUNDING = 1e-9


class Pose(NamedTuple):
    """A place [m] and a direction [rad]."""

    x: float
    y: float
    heading: float


class Arcs(NamedTuple):
    """A way of three parts, driven one after the other."""

    radius: float
    """Radius of the parts that turn [m]."""
    turns: Turns
    """``LEFT``, ``STRAIGHT`` or ``RIGHT`` for each part."""
    lengths: Three
    """Length of each part [m]."""

    @property
    def length(self) -> float:
        """Length of all parts together [m]."""
        return sum(self.lengths)

    def places(self, start: Pose, spacing: float) -> tuple[FloatArray, FloatArray]:
        """Return points (n, 2) [m] and headings (n,) [rad] along the way, both ends included.

        Parameters
        ----------
        start : where the way begins
        spacing : largest distance between points [m]
        """
        points, headings = [np.array([[start.x, start.y]])], [np.array([start.heading])]
        x, y, heading = start
        for turn, length in zip(self.turns, self.lengths, strict=True):
            if length <= _ROUNDING:
                continue
            gone = np.linspace(0.0, length, max(math.ceil(length / spacing), 1) + 1)[1:]
            turned = turn * gone / self.radius
            # A chord points halfway between the directions at its ends.
            chord = gone * np.sinc(0.5 * turned / math.pi)
            direction = heading + 0.5 * turned
            points.append(np.column_stack([x + chord * np.cos(direction), y + chord * np.sin(direction)]))
            headings.append(heading + turned)
            (x, y), heading = points[-1][-1].tolist(), float(headings[-1][-1])
        return np.concatenate(points), np.concatenate(headings)


def between(start: Pose, end: Pose, radius: float) -> Iterator[Arcs]:
    """Yield the ways between two poses; there is always at least one.

    Ways of three turns are also given with a middle turn of less than half a circle. They are never the
    shortest, but they swing out before and behind a bend and so stay nearer to it.

    Parameters
    ----------
    start, end
    radius : of every turn [m]
    """
    east, north = end.x - start.x, end.y - start.y
    direction = math.atan2(north, east)
    apart = math.hypot(east, north) / radius
    leaving, arriving = start.heading - direction, end.heading - direction
    for side in (LEFT, RIGHT):
        # A way that begins to the right is the mirror image of one that begins to the left.
        for turns, parts in _from_the_left(apart, side * leaving, side * arriving):
            first, middle, last = (
                radius * (part if turn == STRAIGHT else _once_round(part))
                for turn, part in zip(turns, parts, strict=True)
            )
            yield Arcs(radius, (side * turns[0], side * turns[1], side * turns[2]), (first, middle, last))


def _from_the_left(apart: float, leaving: float, arriving: float) -> Iterator[tuple[Turns, Three]]:
    """Yield the ways that begin with a turn to the left.

    Parameters
    ----------
    apart : distance between the poses, in radii; the lengths of the parts are in radii too
    leaving, arriving : directions of the poses, relative to the line between them [rad]
    """
    sine, other_sine = math.sin(leaving), math.sin(arriving)
    cosine, other_cosine = math.cos(leaving), math.cos(arriving)
    alike = 2.0 * math.cos(leaving - arriving)
    square = 2.0 + apart**2 - alike + 2.0 * apart * (sine - other_sine)
    way = math.atan2(other_cosine - cosine, apart + sine - other_sine)
    yield (LEFT, STRAIGHT, LEFT), (way - leaving, math.sqrt(max(square, 0.0)), arriving - way)
    square = -2.0 + apart**2 + alike + 2.0 * apart * (sine + other_sine)
    if square >= 0.0:
        straight = math.sqrt(square)
        way = math.atan2(-cosine - other_cosine, apart + sine + other_sine) - math.atan2(-2.0, straight)
        yield (LEFT, STRAIGHT, RIGHT), (way - leaving, straight, way - arriving)
    middle_cosine = (6.0 - apart**2 + alike + 2.0 * apart * (other_sine - sine)) / 8.0
    if abs(middle_cosine) <= 1.0:
        way = math.atan2(cosine - other_cosine, apart + sine - other_sine)
        short = math.acos(middle_cosine)
        for middle in (short, _FULL - short):
            first = 0.5 * middle - leaving - way
            yield (LEFT, RIGHT, LEFT), (first, middle, arriving - leaving - first + middle)


def _once_round(angle: float) -> float:
    """Return the same turn as an angle of at least 0 and less than a full circle [rad]."""
    turned = angle % _FULL
    return 0.0 if _FULL - turned < _ROUNDING else turned
