"""All traffic near crossings of a recorded run, read so that every vehicle takes the place of an ego.

Egos themselves are left out: they are judged from their own recording. A long recording is read in parts, so
that memory does not grow with the simulated time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from analysis.arrays import IntArray
from analysis.recording.columns import EGOS, TRAFFIC
from analysis.recording.opening import opened_table
from analysis.recording.presence import PEDESTRIAN, VEHICLE, around, index_of, span_of
from analysis.recording.reading import (
    Columns,
    RecordedRun,
    all_rows,
    checked_schema,
    declared_columns,
    read_table,
)
from analysis.recording.row_groups import RowGroups

ROWS_AT_ONCE = 500_000
"""A recording with more rows than this is judged in parts, each of road users who appear within about this
many rows."""


def has_traffic(folder: Path) -> bool:
    """Return whether a run's folder holds the traffic near crossings."""
    return (folder / TRAFFIC.file).is_file()


@dataclass(frozen=True, slots=True)
class Part:
    """Some pedestrians near crossings, and all vehicles but egos that were recorded at the same time."""

    run: RecordedRun
    """The run with these vehicles as egos; their tracks are whole."""
    own_vehicles: Set[str]
    """Names of the vehicles that belong to this part alone."""
    begin_s: float
    """No pedestrian or own vehicle of this part or a later one was recorded before this time [s]."""


class Traffic:
    """All traffic near the crossings of a run.

    Parameters
    ----------
    run
        The run with the recording of its egos.

    Raises
    ------
    RecordingError
        As :func:`analysis.recording.reading.read_run`; later reading raises it too if the file changes.
    """

    def __init__(self, run: RecordedRun) -> None:
        self._run = run
        self._path = run.folder / TRAFFIC.file
        egos = set(run.egos.texts["ego_id"].names)
        self._read: Columns | None = None
        with opened_table(self._path) as file:
            checked_schema(self._path, TRAFFIC, file)
            self._short = file.metadata.num_rows <= ROWS_AT_ONCE
            if self._short:
                self._read = all_rows(self._path, TRAFFIC, file)
                self._index = index_of([self._read], egos)
            else:
                self._index = index_of(RowGroups(self._path, TRAFFIC, file), egos)
        self._at_once = max(1, ROWS_AT_ONCE // max(1, max(self._index.rows, default=1)))

    @property
    def run(self) -> RecordedRun:
        """The run with the recording of its egos."""
        return self._run

    @property
    def classes(self) -> Mapping[str, str]:
        """SUMO's class of each vehicle, egos included."""
        return self._index.classes

    def whole(self) -> RecordedRun:
        """Return the whole run at once."""
        return next(self._parts(len(self._index.rows))).run

    def parts(self) -> Iterator[Part]:
        """Yield the parts in the order of time; to save memory, drop each one before you ask for the next."""
        yield from self._parts(self._at_once)

    def _parts(self, groups: int) -> Iterator[Part]:
        index = self._index
        if self._short:
            yield Part(self._of(self._everything()), index.vehicles.keys(), index.begins[0])
            return
        with opened_table(self._path) as file:
            for first in range(0, len(index.rows), groups):
                yield self._part(RowGroups(self._path, TRAFFIC, file), range(first, first + groups))

    def _everything(self) -> Columns:
        """Return all rows; they are not kept, so that they take no memory beside what is made of them."""
        rows, self._read = self._read, None
        return read_table(self._run.folder, TRAFFIC) if rows is None else rows

    def _part(self, recorded: RowGroups, groups: range) -> Part:
        """Return the road users who appear in some row groups, and the vehicles around the pedestrians."""
        index = self._index
        people = {name: seen for name, seen in index.pedestrians.items() if seen.first in groups}
        own = {name for name, seen in index.vehicles.items() if seen.first in groups}
        vehicles = own | around(index.vehicles, people.values())
        there = span_of([*people.values(), *(index.vehicles[name] for name in vehicles)])
        rows = recorded.of(there, {PEDESTRIAN: people.keys(), VEHICLE: vehicles}, "object_kind", "object_id")
        return Part(self._of(rows), own, index.begins[groups.start])

    def _of(self, table: Columns) -> RecordedRun:
        kinds, names = table.texts["object_kind"], table.texts["object_id"]
        other = np.array([name in self._index.vehicles for name in names.names], dtype=np.bool_)
        vehicles = np.flatnonzero(kinds.equal(VEHICLE))
        pedestrians = np.flatnonzero(kinds.equal(PEDESTRIAN))
        return replace(
            self._run,
            times=self._index.times,
            egos=_as_egos(table, vehicles[other[names.codes[vehicles]]]),
            neighbours=declared_columns(TRAFFIC, len(pedestrians), table.picked(pedestrians)),
            sensing=None,
            bystanders=self._egos_during(table),
            largest=self._index.largest,
            places=self._index.places,
        )

    def _egos_during(self, table: Columns) -> Columns:
        """Return the egos at the instants of some rows: they are not judged here, but may hide somebody."""
        egos, times = self._run.egos, table.numbers["time_s"]
        time = np.round(egos.numbers["time_s"], 6)
        there = np.isin(time, np.round(self._index.times, 6))
        if len(times):
            there &= (time >= times.min() - 1e-6) & (time <= times.max() + 1e-6)
        return egos.picked(np.flatnonzero(there))


def _as_egos(table: Columns, rows: IntArray) -> Columns:
    picked = table.picked(rows)
    numbers = picked.numbers
    speed = np.hypot(numbers["x_speed_mps"], numbers["y_speed_mps"])
    as_ego = {
        "front_x_m": numbers["x_m"],
        "front_y_m": numbers["y_m"],
        "speed_mps": speed,
    }
    texts = {"ego_id": picked.texts["object_id"], "lane": picked.texts["edge_or_lane"]}
    return declared_columns(
        EGOS, len(rows), Columns({**numbers, **as_ego}, picked.flags, {**picked.texts, **texts})
    )
