"""Rows to a Parquet file in chunks, so that memory stays flat however long a run is."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

Column = Sequence[Any] | NDArray[np.float64]


class ParquetSink:
    """One table on its way to disk.

    Rows go to ``<path>.part``; ``close`` writes the last ones and gives the file its name, so that a
    file with its final name is always complete. The bytes depend on the rows alone.
    """

    def __init__(self, path: Path, schema: pa.Schema, rows_per_chunk: int = 8192) -> None:
        self._path = path
        self._part = path.with_name(path.name + ".part")
        self._schema = schema
        self._rows_per_chunk = rows_per_chunk
        self._pieces: list[list[Column]] = [[] for _ in schema]
        self._rows: list[Sequence[Any]] = []
        self._waiting = 0
        self._writer = pq.ParquetWriter(
            self._part, schema, version="2.6", compression="zstd", compression_level=3, use_dictionary=True
        )
        self._open = True

    def add_row(self, row: Sequence[Any]) -> None:
        """Add one row, its values in the order of the schema."""
        self._check_width(len(row))
        self._rows.append(row)
        self._count(1)

    def add_columns(self, columns: Sequence[Column]) -> None:
        """Add as many rows as each of the columns is long, in the order of the schema."""
        self._check_width(len(columns))
        count = len(columns[0])
        if any(len(column) != count for column in columns):
            lengths = [len(column) for column in columns]
            raise ValueError(f"{self._path.name}: columns of one length expected, got {lengths}")
        if count == 0:
            return
        self._add_pieces()
        for pieces, column in zip(self._pieces, columns, strict=True):
            # An array may be filled anew before it is written.
            pieces.append(column.copy() if isinstance(column, np.ndarray) else column)
        self._count(count)

    def close(self) -> None:
        """Write what is left and give the file its name; a second call does nothing."""
        if not self._open:
            return
        self._open = False
        try:
            self._flush()
        finally:
            self._writer.close()
            self._part.replace(self._path)

    def _check_width(self, width: int) -> None:
        if width != len(self._schema):
            raise ValueError(f"{self._path.name}: {len(self._schema)} columns expected, got {width}")

    def _count(self, rows: int) -> None:
        self._waiting += rows
        if self._waiting >= self._rows_per_chunk:
            self._flush()

    def _add_pieces(self) -> None:
        """Turn the rows since the last columns into columns."""
        for pieces, column in zip(self._pieces, zip(*self._rows, strict=True), strict=False):
            pieces.append(column)
        self._rows = []

    def _flush(self) -> None:
        if self._waiting == 0:
            return
        self._add_pieces()
        pieces, self._pieces = self._pieces, [[] for _ in self._schema]
        self._waiting = 0
        arrays = [_array(column, field.type) for column, field in zip(pieces, self._schema, strict=True)]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._schema))


def _array(pieces: Sequence[Column], kind: pa.DataType) -> pa.Array:
    """Return one column of its pieces; numbers in arrays are not made Python's one by one."""
    arrays = [piece for piece in pieces if isinstance(piece, np.ndarray)]
    if len(arrays) == len(pieces):
        return pa.array(np.concatenate(arrays), type=kind)
    if len(pieces) == 1:
        return pa.array(pieces[0], type=kind)
    lists = [piece.tolist() if isinstance(piece, np.ndarray) else piece for piece in pieces]
    return pa.array(list(chain.from_iterable(lists)), type=kind)
