"""Tracks of the pedestrians and vehicles that a run records near its egos."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import overload

import numpy as np

from analysis.arrays import IntArray
from analysis.polylines import arc_lengths
from analysis.recording.fine_grid import Grid, by_name, refine, row_of_sample, unbroken
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Track, Way

_PERSON_SPEED_MPS = 12.0


class Tracks(Sequence[Track]):
    """The tracks of all pedestrians or all vehicles, straight between recorded instants.

    Each track is computed on request and not kept: on the fine grid, tracks are many times as large as the
    recording.

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
        numbers = run.levels.of_lanes if self._moves else run.levels.of_edges
        self._levels = numbers(places.names, places.codes)
        self._pieces: list[tuple[str, IntArray]] = []
        self._steps: list[IntArray] = []
        """For each piece, the number of recorded steps from its first row to each of its rows."""
        left_out = np.zeros(len(self._rows), np.int64) if run.left_out is None else run.left_out
        chosen = np.flatnonzero(self._rows.texts["object_kind"].equal(kind))
        for name, index in by_name(self._rows, "object_id", chosen):
            number = {key: values[index] for key, values in self._rows.numbers.items()}
            speed = np.hypot(number["x_speed_mps"], number["y_speed_mps"])
            reach = speed if self._moves else np.full_like(speed, _PERSON_SPEED_MPS)
            pieces = unbroken(run, number["time_s"], number["x_m"], number["y_m"], reach, left_out[index])
            self._pieces += [(name, index[piece]) for piece in pieces]
            self._steps += [np.append(0, np.cumsum(1 + left_out[index[piece][1:]])) for piece in pieces]
        headings = self._rows.numbers["heading_rad"]
        self._headings = [np.unwrap(headings[index]) for _, index in self._pieces] if self._moves else []
        begins = self._rows.numbers["time_s"][[int(index[0]) for _, index in self._pieces]]
        self._firsts = np.searchsorted(run.times, np.round(begins, 6)) * grid.factor
        self._sizes = np.array([int(steps[-1]) * grid.factor + 1 for steps in self._steps], np.int64)

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
        """Return the tracks recorded between two samples of the fine grid, each cut to that stretch."""
        there = np.flatnonzero((self._firsts <= last) & (self._firsts + self._sizes > first))
        return [self.between(number, first, last) for number in there.tolist()]

    def between(self, number: int, first: int, last: int) -> Track:
        """Return the part of a track between two samples of the fine grid; at least one recorded instant."""
        factor, own, end = self._grid.factor, int(self._firsts[number]), int(self._steps[number][-1])
        begin = min(max(0, first - own) // factor, end)
        return self._track(number, begin, max(begin, min(-(-(last - own) // factor), end)))

    def way(self, number: int) -> Way:
        """Return where a vehicle was, without the samples at which it stood and whose rows were left out."""
        factor, steps = self._grid.factor, self._steps[number]
        track = self._made(number, np.arange(len(steps)))
        stood = np.repeat(np.diff(steps) > 1, factor)
        stood[::factor] = False
        fine = (steps[:-1, None] * factor + np.arange(factor)).ravel()
        kept = np.append(~stood, True)
        return Way.of(track, track.first + np.append(fine, steps[-1] * factor), kept)

    def beside(
        self, chosen: Sequence[int], samples: int, first: int, last: int
    ) -> Iterator[dict[int, Track]]:
        """Yield chosen tracks by number, cut as by `between`, about ``samples`` samples at a time."""
        ends = np.minimum(self._firsts + self._sizes - 1, last)
        counts = np.maximum(ends - np.maximum(self._firsts, first) + 1, self._grid.factor)
        for places in _apart(counts[list(chosen)], samples):
            yield {chosen[place]: self.between(chosen[place], first, last) for place in places}

    def ways(self, samples: int) -> Iterator[dict[int, Way]]:
        """Yield all ways by number, about ``samples`` samples at a time."""
        counts = np.array([len(index) for _, index in self._pieces], np.int64) * self._grid.factor
        for numbers in _apart(counts, samples):
            yield {number: self.way(number) for number in numbers}

    def some(self, samples: int, beside: Sequence[Track] = ()) -> Iterator[list[Track]]:
        """Yield all tracks, some at a time; tracks of one name stay together.

        Parameters
        ----------
        samples : int
            Approximate number of samples at a time.
        beside : Sequence
            Other tracks; the samples that a track has at the same time as each of them count as well.
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

    def _track(self, number: int, begin: int = 0, end: int | None = None) -> Track:
        """Return a track, or its part between two of its recorded steps, both included."""
        steps = self._steps[number]
        wanted = np.arange(begin, (int(steps[-1]) if end is None else end) + 1)
        return self._made(number, np.searchsorted(steps, wanted, "right") - 1, begin)

    def _made(self, number: int, rows: IntArray, begin: int = 0) -> Track:
        """Return a track through some of its rows, taken as one step apart, that begins at a given step."""
        name, index = self._pieces[number]
        factor = self._grid.factor
        heading = self._headings[number][rows] if self._moves else np.zeros(0)
        index = index[rows]
        recorded = {key: self._rows.numbers[key][index] for key in _OF_OBJECTS}
        length, width = float(recorded["length_m"][0]), float(recorded["width_m"][0])
        x, y = refine(recorded["x_m"], factor), refine(recorded["y_m"], factor)
        if self._moves:
            heading = refine(heading, factor)
            x = x - 0.5 * length * np.cos(heading)
            y = y - 0.5 * length * np.sin(heading)
        else:
            heading = np.full_like(x, np.nan)
        x_speed = refine(recorded["x_speed_mps"], factor)
        y_speed = refine(recorded["y_speed_mps"], factor)
        samples = row_of_sample(index, factor)
        return Track(
            name=name,
            kind=self._rows.texts["object_type"].at(int(index[0])),
            first=int(self._firsts[number]) + factor * begin,
            rows=samples,
            x=x,
            y=y,
            heading=heading,
            x_speed=x_speed,
            y_speed=y_speed,
            speed=np.hypot(x_speed, y_speed),
            acceleration=np.full_like(x, np.nan),
            path=arc_lengths(np.column_stack([x, y])),
            level=self._levels[samples],
            length=length,
            width=width,
        )


_OF_OBJECTS = ("x_m", "y_m", "x_speed_mps", "y_speed_mps", "length_m", "width_m")


def _apart(counts: IntArray, at_once: int) -> Iterator[range]:
    """Yield ranges of consecutive numbers, each with counts that add up to about ``at_once``."""
    stretch = (np.cumsum(counts) - counts) // at_once
    bounds = [0, *(np.flatnonzero(np.diff(stretch)) + 1).tolist(), len(counts)]
    yield from (range(a, b) for a, b in pairwise(bounds) if a < b)
