"""A recorded table read row group by row group, so that memory does not grow with the simulated time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.arrays import BoolArray
from analysis.errors import RecordingError
from analysis.recording.columns import RecordedTable
from analysis.recording.reading import Columns, checked_rows, completed, judged_names


class RowGroups:
    """The row groups of an opened file.

    Parameters
    ----------
    path
        Path of the file, for error messages.
    declared
        The columns of the file; the judged ones are read.
    file
        The opened file, whose schema was checked.
    """

    def __init__(self, path: Path, declared: RecordedTable, file: pq.ParquetFile) -> None:
        self._path, self._declared, self._file = path, declared, file
        self._names = judged_names(declared, file)

    def __len__(self) -> int:
        return int(self._file.num_row_groups)

    def __iter__(self) -> Iterator[Columns]:
        """Yield the checked rows of one group after the other.

        Raises
        ------
        RecordingError
            As :func:`analysis.recording.reading.read_table`.
        """
        before, latest = 0, _Latest(-np.inf, frozenset())
        for number in range(len(self)):
            rows = checked_rows(self._path, self._declared, self.table(number), before)
            latest = latest.followed(self._path, self._declared.key, rows, before)
            yield rows
            before += len(rows)

    def of(self, groups: range, wanted: Mapping[str, Set[str]], kind: str, name: str) -> Columns:
        """Return the rows of some road users in some groups.

        Parameters
        ----------
        groups
        wanted
            Names of the road users by kind: a vehicle and a person may share a name.
        kind, name
            Columns that hold the kind (empty if all are of one kind) and the name.
        """
        tables = [chosen_rows(self.table(number), wanted, kind, name) for number in groups]
        return checked_rows(self._path, self._declared, pa.concat_tables([self.empty(), *tables]))

    def empty(self) -> pa.Table:
        """Return the judged columns without rows."""
        return completed(self._declared, self._file.schema_arrow.empty_table().select(self._names))

    def table(self, number: int) -> pa.Table:
        """Return the judged columns of one group, unchecked."""
        return completed(self._declared, self._file.read_row_group(number, self._names))


class _Latest(NamedTuple):
    """The last instant of a row group [s], and the keys that have a row then."""

    time: float
    names: Set[tuple[str, ...]]

    def followed(self, path: Path, key: Sequence[str], rows: Columns, before: int) -> _Latest:
        """Return that of the next group, which may begin at the same instant, but not earlier.

        Raises
        ------
        RecordingError
            For time that goes backwards, and a second row of the same key at the same time.
        """
        if not len(rows):
            return self
        time = rows.numbers["time_s"]
        if time[0] < self.time:
            raise RecordingError(
                f"{path}: column 'time_s', row {before + 1}: time goes backwards "
                f"from {self.time:g} s to {time[0]:g} s"
            )
        for row in np.flatnonzero(time <= self.time + 1e-9).tolist():
            if (names := _key(rows, key, row)) in self.names:
                raise RecordingError(
                    f"{path}: column 'time_s', row {before + row + 1}: {', '.join(map(repr, names))} "
                    f"has a second row at {time[row]:g} s"
                )
        last = np.flatnonzero(time >= time[-1] - 1e-9).tolist()
        known = self.names if time[0] >= time[-1] - 1e-9 and time[-1] <= self.time + 1e-9 else frozenset()
        return _Latest(float(time[-1]), known | {_key(rows, key, row) for row in last})


def _key(rows: Columns, key: Sequence[str], row: int) -> tuple[str, ...]:
    return tuple(rows.texts[name].at(row) for name in key)


def chosen_rows(table: pa.Table, wanted: Mapping[str, Set[str]], kind: str, name: str) -> pa.Table:
    """Return the rows of some road users, as `RowGroups.of`."""
    if not len(table):
        return table
    names = table[name].combine_chunks().dictionary_encode()
    kinds = table[kind].combine_chunks().dictionary_encode() if kind else None
    kept = np.zeros(len(table), dtype=np.bool_)
    for one, some in wanted.items():
        is_wanted = _are(names, some)
        kept |= is_wanted if kinds is None else is_wanted & _are(kinds, {one})
    return table.filter(pa.array(kept))


def _are(column: pa.DictionaryArray, names: Set[str]) -> BoolArray:
    known = np.array([name in names for name in column.dictionary.to_pylist()], dtype=np.bool_)
    return np.asarray(known[column.indices.to_numpy()])
