"""Rows of a declared table to its Parquet file: each column's value is looked up where its source says."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from analysis.recording.columns import RecordedTable
from analysis.tables.column import follow
from cosim.parquet_sink import ROWS_PER_CHUNK, Column, ParquetSink


class TableWriter:
    """One recorded table of a run's folder."""

    def __init__(self, folder: Path, table: RecordedTable, rows_per_chunk: int = ROWS_PER_CHUNK) -> None:
        self._sink = ParquetSink(folder / table.file, table.schema, rows_per_chunk)
        self._values = tuple(follow(column.source) for column in table.columns)

    def add(self, made_of: Any) -> None:
        """Add the row of one object."""
        self._sink.add_row([_cell(value_of(made_of)) for value_of in self._values])

    def add_all(self, made_of: Any, count: int) -> None:
        """Add ``count`` rows of an object that holds for each column a sequence, or one value for all."""
        self._sink.add_columns([_column(value_of(made_of), count) for value_of in self._values])

    def close(self) -> None:
        """Write what is left and make the file."""
        self._sink.close()


def _cell(value: Any) -> Any:
    """Return a value without numbers that are not finite: undefined is null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value.tolist() if isinstance(value, np.ndarray) else value


def _column(value: Any, count: int) -> Column:
    if isinstance(value, np.ndarray):
        finite = value.dtype.kind != "f" or np.isfinite(value).all()
        return value if finite else [_cell(one) for one in value.tolist()]
    return value if isinstance(value, tuple | list) else [value] * count
