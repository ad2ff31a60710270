"""Paths of egos, persons and vehicles on one fine time grid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Track:
    """One uninterrupted path; arrays over consecutive samples of the fine grid."""

    name: str
    kind: str
    """SUMO type id; empty for an ego."""
    first: int
    """Fine index of the first sample."""
    rows: IntArray
    """Row of the recorded table at or before each sample."""
    x: FloatArray
    """Centre of the body [m]."""
    y: FloatArray
    heading: FloatArray
    """Unwrapped [rad]; nan for a person."""
    x_speed: FloatArray
    y_speed: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    """Recorded acceleration of an ego [m/s^2]; nan for others."""
    path: FloatArray
    """Distance along the path from the first sample [m]."""
    level: IntArray
    """Number of the edge that the body is on, as in ``RecordedRun.levels``."""
    length: float
    width: float

    @property
    def fine(self) -> IntArray:
        """Fine index of each sample."""
        return np.arange(self.first, self.last + 1)

    @property
    def last(self) -> int:
        """Fine index of the last sample."""
        return self.first + len(self.x) - 1

    @cached_property
    def largest_step(self) -> float:
        """Largest distance that the centre moves in one sample [m]."""
        return float(np.diff(self.path).max()) if len(self.x) > 1 else 0.0

    @cached_property
    def largest_shift(self) -> float:
        """Upper bound of the distance that a corner of the body moves in one sample [m]."""
        if len(self.x) < 2:
            return 0.0
        corner = 0.5 * float(np.hypot(self.length, self.width))
        return float((np.diff(self.path) + corner * np.abs(np.diff(self.heading))).max())

    @cached_property
    def places(self) -> tuple[FloatArray, FloatArray]:
        """Places without repeats: x and y of the samples at which the track is elsewhere than before [m]."""
        moved = np.append(True, (self.x[1:] != self.x[:-1]) | (self.y[1:] != self.y[:-1]))
        return self.x[moved], self.y[moved]

    def between(self, first: int, last: int) -> Track:
        """Return the part between two samples of this track, both included."""
        part = slice(first, last + 1)
        arrays = {name: getattr(self, name)[part] for name in _ARRAYS}
        return replace(self, first=self.first + first, **arrays)


_ARRAYS = tuple(
    one.name for one in fields(Track) if one.name not in ("name", "kind", "first", "length", "width")
)


There = Callable[[int, int], Sequence[Track]]
"""Function that returns the tracks with a sample between two samples of the fine grid, both included; the
tracks may be cut to that stretch."""


@dataclass(frozen=True, slots=True)
class Way:
    """Where a vehicle was, at the samples of its track that differ from the one before or after."""

    name: str
    fine: IntArray
    """Fine index of each sample, ascending; between two that are not consecutive, the vehicle stood."""
    x: FloatArray
    y: FloatArray
    heading: FloatArray
    x_speed: FloatArray
    y_speed: FloatArray
    speed: FloatArray
    path: FloatArray
    level: IntArray
    length: float
    width: float

    @property
    def stood(self) -> bool:
        """Whether the vehicle stood most of the time."""
        return bool(2 * len(self.fine) < self.fine[-1] - self.fine[0])

    @classmethod
    def of(cls, track: Track, fine: IntArray, kept: BoolArray) -> Way:
        """Return some samples of a track, given the fine index of all of them."""
        names = ("x", "y", "heading", "x_speed", "y_speed", "speed", "path", "level")
        arrays = {name: getattr(track, name)[kept] for name in names}
        return cls(name=track.name, fine=fine[kept], length=track.length, width=track.width, **arrays)


def way_of(track: Track) -> Way:
    """Return the way of an ego."""
    moved = np.zeros(len(track.x) - 1, dtype=np.bool_)
    for values in (track.x, track.y, track.heading, track.speed, track.level):
        moved |= values[1:] != values[:-1]
    kept = np.append(True, moved) | np.append(moved, True)
    return Way.of(track, track.fine, kept)
