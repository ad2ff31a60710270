"""All traffic near crossings of a recorded run, read so that every vehicle takes the place of an ego.

Egos themselves are left out: they are judged from their own recording. A long recording is read in parts, so
that memory does not grow with the simulated time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.arrays import FloatArray, IntArray
from analysis.recording.columns import EGOS, TRAFFIC, RecordedTable
from analysis.recording.opening import opened_table
from analysis.recording.reading import (
    Columns,
    RecordedRun,
    Texts,
    checked_rows,
    checked_schema,
    completed,
    read_table,
)
from analysis.recording.traffic_index import PEDESTRIAN, VEHICLE, around, index_of

ROWS_AT_ONCE = 500_000
"""A recording with more rows is judged in parts that begin in about so many."""


def has_traffic(folder: Path) -> bool:
    """Return whether a run's folder holds the traffic near crossings."""
    return (folder / TRAFFIC.file).is_file()


@dataclass(frozen=True, slots=True)
class Part:
    """Some pedestrians near crossings, and all other vehicles that were there while they were."""

    run: RecordedRun
    """The run with these vehicles for egos; their tracks are whole."""
    own_vehicles: Set[str]
    """Names of vehicles that belong to this part and to no other one."""
    begin_s: float
    """Nobody of this part or a later one was there before [s]."""


class Traffic:
    """All traffic near the crossings of a run.

    Parameters
    ----------
    run
        What is recorded of its egos.

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
                self._read = checked_rows(self._path, TRAFFIC, completed(TRAFFIC, file.read()))
                self._index = index_of(self._path, [self._read], egos)
            else:
                self._index = index_of(self._path, self._groups(file), egos)
        self._at_once = max(1, ROWS_AT_ONCE // max(1, max(self._index.rows, default=1)))

    @property
    def classes(self) -> Mapping[str, str]:
        """SUMO's class of each vehicle, egos included."""
        return self._index.classes

    def whole(self) -> RecordedRun:
        """Return everything at once."""
        return next(self._parts(len(self._index.rows))).run

    def parts(self) -> Iterator[Part]:
        """Yield the parts in the order of time; whoever is done with one lets go of it before the next."""
        yield from self._parts(self._at_once)

    def _groups(self, file: pq.ParquetFile) -> Iterator[Columns]:
        before = 0
        for number in range(file.num_row_groups):
            table = completed(TRAFFIC, file.read_row_group(number))
            yield checked_rows(self._path, TRAFFIC, table, before)
            before += len(table)

    def _parts(self, groups: int) -> Iterator[Part]:
        index = self._index
        if self._short:
            yield Part(self._of(self._everything()), index.vehicles.keys(), index.begins[0])
            return
        with opened_table(self._path) as file:
            for first in range(0, len(index.rows), groups):
                yield self._part(file, range(first, first + groups))

    def _everything(self) -> Columns:
        """Return all rows, which are not kept beside what is made of them."""
        rows, self._read = self._read, None
        return read_table(self._run.folder, TRAFFIC) if rows is None else rows

    def _part(self, file: pq.ParquetFile, groups: range) -> Part:
        """Return those who were seen first in some row groups, and the vehicles around the pedestrians."""
        index = self._index
        people = {name: seen for name, seen in index.pedestrians.items() if seen.first in groups}
        own = {name for name, seen in index.vehicles.items() if seen.first in groups}
        vehicles = own | around(index.vehicles, people.values())
        spans = [*people.values(), *(index.vehicles[name] for name in vehicles)]
        first, last = (
            min((one.first for one in spans), default=0),
            max((one.last for one in spans), default=-1),
        )
        tables = [
            _chosen(completed(TRAFFIC, file.read_row_group(number)), people.keys(), vehicles)
            for number in range(first, last + 1)
        ]
        table = pa.concat_tables([completed(TRAFFIC, file.schema_arrow.empty_table()), *tables])
        rows = checked_rows(self._path, TRAFFIC, table)
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
            neighbours=_columns(TRAFFIC, len(pedestrians), _picked(table, pedestrians)),
            sensing=None,
            largest=self._index.largest,
        )


def _chosen(table: pa.Table, people: Set[str], vehicles: Set[str]) -> pa.Table:
    """Return the rows of some pedestrians and vehicles; a vehicle and a person may share a name."""
    names, kinds = (table[name].combine_chunks().dictionary_encode() for name in ("object_id", "object_kind"))
    kept = np.zeros(len(table), dtype=np.bool_)
    for kind, wanted in ((PEDESTRIAN, people), (VEHICLE, vehicles)):
        is_wanted = np.array([name in wanted for name in names.dictionary.to_pylist()], dtype=np.bool_)
        is_kind = np.array([name == kind for name in kinds.dictionary.to_pylist()], dtype=np.bool_)
        if len(table):
            kept |= is_wanted[names.indices.to_numpy()] & is_kind[kinds.indices.to_numpy()]
    return table.filter(pa.array(kept))


def _as_egos(table: Columns, rows: IntArray) -> Columns:
    picked = _picked(table, rows)
    numbers = picked.numbers
    speed = np.hypot(numbers["x_speed_mps"], numbers["y_speed_mps"])
    as_ego = {
        "front_x_m": numbers["x_m"],
        "front_y_m": numbers["y_m"],
        "speed_mps": speed,
    }
    texts = {"ego_id": picked.texts["object_id"], "lane": picked.texts["edge_or_lane"]}
    return _columns(EGOS, len(rows), Columns({**numbers, **as_ego}, picked.flags, {**picked.texts, **texts}))


def _picked(table: Columns, rows: IntArray) -> Columns:
    return Columns(
        {name: values[rows] for name, values in table.numbers.items()},
        {name: values[rows] for name, values in table.flags.items()},
        {name: Texts(values.codes[rows], values.names) for name, values in table.texts.items()},
    )


def _columns(declared: RecordedTable, count: int, given: Columns) -> Columns:
    """Return the judged columns of a table; those that are not given are undefined."""
    judged = [column for column in declared.columns if column.judged]
    undefined, never = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)  # shared: nobody writes there
    undefined.flags.writeable = never.flags.writeable = False
    numbers: dict[str, FloatArray] = {}
    for column in judged:
        if column.kind in ("number", "integer"):
            numbers[column.name] = given.numbers.get(column.name, undefined)
    nothing = Texts(np.full(count, -1, dtype=np.int64), ())
    return Columns(
        numbers,
        {one.name: given.flags.get(one.name, never) for one in judged if one.kind == "boolean"},
        {one.name: given.texts.get(one.name, nothing) for one in judged if one.kind == "string"},
    )
