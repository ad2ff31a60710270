"""The egos of a run and all road users near them, one part of the run at a time.

Every ego belongs to one part, which holds its whole ride and the whole tracks of all pedestrians and vehicles
that were recorded during it, so that results do not depend on how a run is divided. Egos of other parts that
were recorded at the same time are *bystanders*, which may hide a pedestrian.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import ExitStack
from dataclasses import dataclass, replace

import numpy as np

from analysis.arrays import IntArray
from analysis.recording.columns import NEIGHBOURS, SENSING
from analysis.recording.fine_grid import samples_per_step
from analysis.recording.opening import opened_table
from analysis.recording.presence import Index, Seen, around, index_of, span_of
from analysis.recording.reading import (
    Columns,
    RecordedRun,
    all_rows,
    all_times,
    checked_schema,
    read_table,
    senses,
)
from analysis.recording.row_groups import RowGroups
from analysis.recording.standing import WithoutRepeats
from analysis.thresholds import Thresholds

SAMPLES_AT_ONCE = 1_000_000
"""Rides with more samples of the fine time grid than this are judged in parts, each of rides that begin
within about this many samples."""


@dataclass(frozen=True, slots=True)
class Part:
    """Some egos of a run, and all that was recorded near egos at the same time."""

    run: RecordedRun
    rows: IntArray
    """Numbers of their rows among the rows of all egos."""


class Rides:
    """The rides of all egos of a run.

    Parameters
    ----------
    run : RecordedRun
        As :func:`analysis.recording.reading.read_rides` gives it.
    thresholds : Thresholds

    Raises
    ------
    RecordingError
        As :func:`analysis.recording.reading.read_run`; later reading raises it too if a file changes.
    """

    def __init__(self, run: RecordedRun, thresholds: Thresholds) -> None:
        self._path = run.folder / NEIGHBOURS.file
        self._at_once = max(1, SAMPLES_AT_ONCE // samples_per_step(run, thresholds))
        self._margin_s = thresholds.severity_pet_slight_s
        """Vehicles recorded up to this long before or after an ego count as well [s]."""
        self._read: Columns | None = None
        self._index = Index()
        length, width = (run.egos.numbers[name] for name in ("length_m", "width_m"))
        self._largest = float((0.5 * np.hypot(length, width)).max(initial=0.0))
        with opened_table(self._path) as file:
            checked_schema(self._path, NEIGHBOURS, file)
            self._short = file.metadata.num_rows + len(run.egos) <= self._at_once
            if self._short:
                self._read = all_rows(self._path, NEIGHBOURS, file)
                times = self._read.numbers["time_s"]
            else:
                self._index = index_of(RowGroups(self._path, NEIGHBOURS, file))
                times = self._index.times
        self.run = replace(run, times=all_times(run.egos.numbers["time_s"], times))
        """The whole run, without what was near its egos."""

    def parts(self) -> Iterator[Part]:
        """Yield the parts; to save memory, drop each one before you ask for the next."""
        if self._short:
            neighbours, self._read = self._read, None
            yield Part(
                replace(
                    self.run,
                    neighbours=read_table(self.run.folder, NEIGHBOURS) if neighbours is None else neighbours,
                    sensing=read_table(self.run.folder, SENSING) if senses(self.run) else None,
                ),
                np.arange(len(self.run.egos)),
            )
            return
        egos = self._egos()
        with ExitStack() as opened:
            file = opened.enter_context(opened_table(self._path))
            near = WithoutRepeats(self._path, file, self.run.times)
            told = _Told(self.run, opened) if senses(self.run) else None
            for names in _together(egos, self._counts(), self._at_once):
                yield self._part(near, told, egos, names)

    def _egos(self) -> Mapping[str, Seen]:
        """Return when each ego was recorded, and in which stretches of about ``at_once`` rows."""
        rows, times = self.run.egos, self.run.times
        own = rows.numbers["time_s"]
        there = np.bincount(np.searchsorted(times, np.round(own, 6)), minlength=len(times))
        there[np.searchsorted(times, self._index.times)] += self._index.at_once
        stretch = (np.cumsum(there) - there) // self._at_once
        names = rows.texts["ego_id"]
        codes, first = np.unique(names.codes, return_index=True)
        last = len(own) - 1 - np.unique(names.codes[::-1], return_index=True)[1]
        since, until = np.round(own[first], 6), np.round(own[last], 6)
        spans = [stretch[np.searchsorted(times, one)].tolist() for one in (since, until)]
        found = zip(*spans, since.tolist(), until.tolist(), strict=True)
        return {names.names[code]: Seen(*one) for code, one in zip(codes.tolist(), found, strict=True)}

    def _counts(self) -> Mapping[str, int]:
        """Return how many rows each ego has."""
        names = self.run.egos.texts["ego_id"]
        counts = np.bincount(names.codes, minlength=len(names.names)).tolist()
        return dict(zip(names.names, counts, strict=True))

    def _part(
        self, near: WithoutRepeats, told: _Told | None, egos: Mapping[str, Seen], names: Set[str]
    ) -> Part:
        index, run = self._index, self.run
        span = _span([egos[name] for name in names], self._margin_s)
        people, vehicles = around(index.pedestrians, [span]), around(index.vehicles, [span])
        rows = _rows_of(run.egos, names)
        neighbours, left_out = near.of(
            people,
            span_of(index.pedestrians[one] for one in people),
            vehicles,
            span_of(index.vehicles[one] for one in vehicles),
        )
        part = replace(
            run,
            egos=run.egos.picked(rows),
            neighbours=neighbours,
            left_out=left_out,
            sensing=None if told is None else told.by(names),
            largest=(max(index.largest[0], self._largest), index.largest[1]),
            places={*index.places, *run.egos.texts["lane"].names},
            bystanders=run.egos.picked(_rows_of(run.egos, around(egos, [span]) - names)),
        )
        return Part(part, rows)


def _together(egos: Mapping[str, Seen], own: Mapping[str, int], at_once: int) -> Iterator[Set[str]]:
    """Yield together the egos that come in one stretch and leave in it or the next; then the others.

    The others stay longer. They are grouped with each other by time, up to ``at_once`` rows in all. Egos of
    short rides are not grouped with them, because more would have to be read for these.
    """
    short: dict[int, set[str]] = {}
    long: list[tuple[Seen, str]] = []
    for name, seen in egos.items():
        if seen.last <= seen.first + 1:
            short.setdefault(seen.first, set()).add(name)
        else:
            long.append((seen, name))
    yield from (short[key] for key in sorted(short))
    some: set[str] = set()
    for _, name in sorted(long):
        if some and sum(own[one] for one in some) + own[name] > at_once:
            yield some
            some = set()
        some.add(name)
    if some:
        yield some


def _span(some: Sequence[Seen], margin_s: float) -> Seen:
    since, until = min(one.since_s for one in some), max(one.until_s for one in some)
    return Seen(0, 0, since - margin_s, until + margin_s)


def _rows_of(egos: Columns, names: Set[str]) -> IntArray:
    own = egos.texts["ego_id"]
    wanted = np.array([name in names for name in own.names], dtype=np.bool_)
    return np.flatnonzero(wanted[own.codes])


class _Told:
    """What egos knew of pedestrians, ego by ego."""

    def __init__(self, run: RecordedRun, opened: ExitStack) -> None:
        path = run.folder / SENSING.file
        file = opened.enter_context(opened_table(path))
        checked_schema(path, SENSING, file)
        self._recorded = RowGroups(path, SENSING, file)
        self._groups: dict[str, range] = {}
        for number, rows in enumerate(self._recorded):
            names = rows.texts["ego_id"].names
            self._groups |= {
                name: range(self._groups.get(name, range(number, number)).start, number + 1) for name in names
            }

    def by(self, egos: Set[str]) -> Columns:
        """Return what some egos knew."""
        some = [self._groups[name] for name in egos if name in self._groups]
        first = min((one.start for one in some), default=0)
        groups = range(first, max((one.stop for one in some), default=first))
        return self._recorded.of(groups, {"": egos}, "", "ego_id")
