"""Paths of egos, persons and vehicles on one fine time grid.

Recorded instants are refined by an integer factor so that samples are at most ``substep_s`` apart. An
object that is out of the recording for an instant, or that jumps, continues as a new track.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import overload

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.polylines import arc_lengths
from analysis.recording.reading import Columns, RecordedRun
from analysis.thresholds import Thresholds

_JUMP_M = 2.0
_PERSON_SPEED_MPS = 12.0


@dataclass(frozen=True, slots=True)
class Grid:
    """The fine time grid of a run."""

    factor: int
    """Fine samples per recorded step."""
    time: FloatArray
    """[s]; sample ``k * factor`` is recorded instant k."""


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
    """Way from the first sample on [m]."""
    level: IntArray
    """Number of the edge it is on, as ``RecordedRun.levels`` counts."""
    length: float
    width: float

    @property
    def last(self) -> int:
        """Fine index of the last sample."""
        return self.first + len(self.x) - 1

    @cached_property
    def largest_step(self) -> float:
        """How far the centre gets in one sample at most [m]."""
        return float(np.diff(self.path).max()) if len(self.x) > 1 else 0.0

    @cached_property
    def largest_shift(self) -> float:
        """How far a corner of the body gets in one sample at most [m]."""
        if len(self.x) < 2:
            return 0.0
        corner = 0.5 * float(np.hypot(self.length, self.width))
        return float((np.diff(self.path) + corner * np.abs(np.diff(self.heading))).max())

    def between(self, first: int, last: int) -> Track:
        """Return the part between two samples of this track, both included."""
        part = slice(first, last + 1)
        arrays = {name: getattr(self, name)[part] for name in _ARRAYS}
        return replace(self, first=self.first + first, **arrays)


_ARRAYS = tuple(
    one.name for one in fields(Track) if one.name not in ("name", "kind", "first", "length", "width")
)


def samples_per_step(run: RecordedRun, thresholds: Thresholds) -> int:
    """Return how many samples of the fine grid there are in a recorded step."""
    return max(1, math.ceil(run.step_s / thresholds.substep_s - 1e-9))


def make_grid(run: RecordedRun, thresholds: Thresholds) -> Grid:
    """Return the fine grid of a run."""
    factor = samples_per_step(run, thresholds)
    return Grid(factor, _refine(run.times, factor))


def ego_tracks(
    run: RecordedRun, grid: Grid, thresholds: Thresholds, rows: Columns | None = None
) -> list[Track]:
    """Return the egos' tracks: cubic Hermite in the rear axle's position and velocity, linear heading.

    Parameters
    ----------
    run : RecordedRun
    grid : Grid
    thresholds : Thresholds
    rows : Columns
        Of egos; those of the run by default.

    Notes
    -----
    The cubic is replaced by the straight line in a step where it would run backwards (its end slopes
    exceed three times the mean slope), which happens when a vehicle stops within the step.
    """
    tracks = []
    rows = run.egos if rows is None else rows
    levels = run.levels.of_all(rows.texts["lane"].names, rows.texts["lane"].codes)
    for name, index in _by_name(rows, "ego_id"):
        number = {key: values[index] for key, values in rows.numbers.items()}
        for piece in _pieces(
            run, number["time_s"], number["front_x_m"], number["front_y_m"], number["speed_mps"]
        ):
            length, width = float(number["length_m"][piece][0]), float(number["width_m"][piece][0])
            heading = np.unwrap(number["heading_rad"][piece])
            speed = number["speed_mps"][piece]
            time = number["time_s"][piece]
            lever = length - thresholds.ego_rear_overhang_m
            axle_x = number["front_x_m"][piece] - lever * np.cos(heading)
            axle_y = number["front_y_m"][piece] - lever * np.sin(heading)
            fine_heading = _refine(heading, grid.factor)
            fine_speed = _refine(speed, grid.factor)
            ahead = 0.5 * length - thresholds.ego_rear_overhang_m
            cubic = _runs_forward(time, axle_x, axle_y, heading, speed)
            axle = [
                _hermite(time, values, slope, cubic, grid.factor)
                for values, slope in (
                    (axle_x, speed * np.cos(heading)),
                    (axle_y, speed * np.sin(heading)),
                )
            ]
            x, y = axle[0] + ahead * np.cos(fine_heading), axle[1] + ahead * np.sin(fine_heading)
            tracks.append(
                Track(
                    name=name,
                    kind="",
                    first=_step(run, time[0]) * grid.factor,
                    rows=_row_of_sample(index[piece], grid.factor),
                    x=x,
                    y=y,
                    heading=fine_heading,
                    x_speed=fine_speed * np.cos(fine_heading),
                    y_speed=fine_speed * np.sin(fine_heading),
                    speed=fine_speed,
                    acceleration=_refine(number["acceleration_mps2"][piece], grid.factor),
                    path=arc_lengths(np.column_stack([x, y])),
                    level=levels[_row_of_sample(index[piece], grid.factor)],
                    length=length,
                    width=width,
                )
            )
    return tracks


There = Callable[[int, int], Sequence[Track]]
"""Gives the tracks with a sample between two of the fine grid, both included, or what of them lies there."""


class Tracks(Sequence[Track]):
    """The tracks of all pedestrians or all vehicles, straight between recorded instants.

    Each is made when it is asked for, and not kept: on the fine grid they are many times as large as what is
    recorded.

    Parameters
    ----------
    run : RecordedRun
    grid : Grid
    kind : str
        ``pedestrian`` or ``vehicle``.
    """

    def __init__(self, run: RecordedRun, grid: Grid, kind: str) -> None:
        self._rows, self._grid, self._moves = run.neighbours, grid, kind == "vehicle"
        places = self._rows.texts["edge_or_lane"]
        self._levels = run.levels.of_all(places.names, places.codes)
        self._pieces: list[tuple[str, IntArray]] = []
        chosen = np.flatnonzero(self._rows.texts["object_kind"].equal(kind))
        for name, index in _by_name(self._rows, "object_id", chosen):
            number = {key: values[index] for key, values in self._rows.numbers.items()}
            speed = np.hypot(number["x_speed_mps"], number["y_speed_mps"])
            reach = speed if self._moves else np.full_like(speed, _PERSON_SPEED_MPS)
            pieces = _pieces(run, number["time_s"], number["x_m"], number["y_m"], reach)
            self._pieces += [(name, index[piece]) for piece in pieces]
        headings = self._rows.numbers["heading_rad"]
        self._headings = [np.unwrap(headings[index]) for _, index in self._pieces] if self._moves else []
        begins = self._rows.numbers["time_s"][[int(index[0]) for _, index in self._pieces]]
        self._firsts = np.searchsorted(run.times, np.round(begins, 6)) * grid.factor
        self._sizes = np.array([(len(index) - 1) * grid.factor + 1 for _, index in self._pieces], np.int64)

    def __len__(self) -> int:
        return len(self._pieces)

    @overload
    def __getitem__(self, index: int) -> Track: ...
    @overload
    def __getitem__(self, index: slice) -> list[Track]: ...
    def __getitem__(self, index: int | slice) -> Track | list[Track]:
        numbers = range(len(self))[index]
        return self._track(numbers) if isinstance(numbers, int) else [self._track(one) for one in numbers]

    def __iter__(self) -> Iterator[Track]:
        return map(self._track, range(len(self)))

    def during(self, first: int, last: int) -> list[Track]:
        """Return the tracks between two samples of the fine grid, of each no more than what lies there."""
        factor, found = self._grid.factor, []
        for number in np.flatnonzero((self._firsts <= last) & (self._firsts + self._sizes > first)).tolist():
            own = int(self._firsts[number])
            begin, end = max(0, first - own) // factor, -(-(last - own) // factor)
            found.append(self._track(number, slice(begin, end + 1)))
        return found

    def some(self, samples: int, beside: Sequence[Track] = ()) -> Iterator[list[Track]]:
        """Yield all tracks some at a time; those of one name are not parted.

        Parameters
        ----------
        samples : int
            About so many there are at a time, those that a track has beside each of some others included.
        beside : Sequence
            The others.
        """
        begin, count = 0, 0
        for end in range(1, len(self) + 1):
            count += int(self._sizes[end - 1]) + self._samples_beside(end - 1, beside)
            parted = end < len(self) and self._pieces[end][0] == self._pieces[end - 1][0]
            if end == len(self) or (not parted and count >= samples):
                yield self[begin:end]
                begin, count = end, 0

    def _samples_beside(self, number: int, others: Sequence[Track]) -> int:
        first, last = int(self._firsts[number]), int(self._firsts[number] + self._sizes[number]) - 1
        return sum(max(0, min(last, one.last) - max(first, one.first) + 1) for one in others)

    def _track(self, number: int, steps: slice = slice(None)) -> Track:
        """Return a track, or some recorded steps of it."""
        name, index = self._pieces[number]
        factor = self._grid.factor
        heading = self._headings[number][steps] if self._moves else np.zeros(0)
        index = index[steps]
        recorded = {key: self._rows.numbers[key][index] for key in _OF_OBJECTS}
        length, width = float(recorded["length_m"][0]), float(recorded["width_m"][0])
        x, y = _refine(recorded["x_m"], factor), _refine(recorded["y_m"], factor)
        if self._moves:
            heading = _refine(heading, factor)
            x = x - 0.5 * length * np.cos(heading)
            y = y - 0.5 * length * np.sin(heading)
        else:
            heading = np.full_like(x, np.nan)
        x_speed = _refine(recorded["x_speed_mps"], factor)
        y_speed = _refine(recorded["y_speed_mps"], factor)
        rows = _row_of_sample(index, factor)
        return Track(
            name=name,
            kind=self._rows.texts["object_type"].at(int(index[0])),
            first=int(self._firsts[number]) + factor * (steps.start or 0),
            rows=rows,
            x=x,
            y=y,
            heading=heading,
            x_speed=x_speed,
            y_speed=y_speed,
            speed=np.hypot(x_speed, y_speed),
            acceleration=np.full_like(x, np.nan),
            path=arc_lengths(np.column_stack([x, y])),
            level=self._levels[rows],
            length=length,
            width=width,
        )


_OF_OBJECTS = ("x_m", "y_m", "x_speed_mps", "y_speed_mps", "length_m", "width_m")


def _by_name(rows: Columns, key: str, chosen: IntArray | None = None) -> Iterator[tuple[str, IntArray]]:
    """Yield each name in alphabetical order with its rows, ascending in time."""
    texts = rows.texts[key]
    index = np.arange(len(rows)) if chosen is None else chosen
    if len(index) == 0:
        return
    codes = texts.codes[index]
    order = np.argsort(codes, kind="stable")
    bounds = np.flatnonzero(np.diff(codes[order])) + 1
    groups = [index[part] for part in np.split(order, bounds)]
    yield from sorted((texts.at(int(group[0])), group) for group in groups)


def _pieces(
    run: RecordedRun, time: FloatArray, x: FloatArray, y: FloatArray, speed: FloatArray
) -> list[slice]:
    """Return the stretches without a missing instant and without a jump."""
    step = np.searchsorted(run.times, np.round(time, 6))
    reach = 1.5 * np.maximum(speed[1:], speed[:-1]) * np.diff(time) + _JUMP_M
    broken = (np.diff(step) != 1) | (np.hypot(np.diff(x), np.diff(y)) > reach)
    ends = [0, *(np.flatnonzero(broken) + 1).tolist(), len(time)]
    return [slice(a, b) for a, b in pairwise(ends)]


def _step(run: RecordedRun, time: float) -> int:
    return int(np.searchsorted(run.times, np.round(time, 6)))


def _refine(values: FloatArray, factor: int) -> FloatArray:
    """Return the values with ``factor − 1`` linearly interpolated ones between each two."""
    if factor == 1 or len(values) < 2:
        return values.astype(np.float64)
    share = np.arange(factor) / factor
    between = values[:-1, None] + np.diff(values)[:, None] * share
    return np.append(between.ravel(), values[-1])


def _row_of_sample(rows: IntArray, factor: int) -> IntArray:
    return np.repeat(rows, factor)[: (len(rows) - 1) * factor + 1]


def _runs_forward(
    time: FloatArray, x: FloatArray, y: FloatArray, heading: FloatArray, speed: FloatArray
) -> BoolArray:
    if len(time) < 2:
        return np.zeros(0, dtype=np.bool_)
    middle = 0.5 * (heading[1:] + heading[:-1])
    mean = (np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle)) / np.diff(time)
    return np.asarray((speed[:-1] <= 3.0 * mean) & (speed[1:] <= 3.0 * mean))


def _hermite(
    time: FloatArray, values: FloatArray, slopes: FloatArray, cubic: BoolArray, factor: int
) -> FloatArray:
    if factor == 1 or len(values) < 2:
        return values.astype(np.float64)
    s = (np.arange(factor) / factor)[None, :]
    step = np.diff(time)[:, None]
    start, change = values[:-1, None], np.diff(values)[:, None]
    first = step * slopes[:-1, None] - change
    second = change - step * slopes[1:, None]
    bend = s * (1.0 - s) * (first * (1.0 - s) + second * s)
    between = start + s * change + np.where(cubic[:, None], bend, 0.0)
    return np.append(between.ravel(), values[-1])
