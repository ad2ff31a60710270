"""Writes the rows of a declared table to its Parquet file, reading each column's value from its source."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.recording.columns import RecordedTable
from cosim.recording.parquet_sink import ROWS_PER_CHUNK, Column, ParquetSink
from cosim.recording.source_reader import SourceReader


class TableWriter:
    """Writes one recorded table in a run's folder."""

    def __init__(self, folder: Path, table: RecordedTable, rows_per_chunk: int = ROWS_PER_CHUNK) -> None:
        self._sink = ParquetSink(folder / table.file, table.schema, rows_per_chunk)
        self._sources = SourceReader([column.source for column in table.columns])
        self._decimals = [
            table.decimals if column.decimals is None else column.decimals for column in table.columns
        ]
        self._lists = [place for place, column in enumerate(table.columns) if column.kind == "numbers"]

    def add(self, made_of: Any) -> None:
        """Add the row of one object; numbers that are not finite are undefined and become null."""
        row: list[Any] = [
            None if isinstance(value, float) and not isfinite(value) else value
            for value in self._sources.read(made_of)
        ]
        for place in self._lists:
            row[place] = row[place].tolist()  # the caller may overwrite the array before it is written
        self._sink.add_row(tuple(row))  # the garbage collector skips tuples of numbers and texts

    def add_all(self, made_of: Any, count: int) -> None:
        """Add ``count`` rows of an object that has, for each column, a sequence or one value for all rows."""
        values = self._sources.read(made_of)
        rounded = zip(values, self._decimals, strict=True)
        self._sink.add_columns([_column(value, count, decimals) for value, decimals in rounded])

    def close(self) -> None:
        """Write the remaining rows and make the file."""
        self._sink.close()


def _column(value: Any, count: int, decimals: int | None) -> Column:
    if isinstance(value, np.ndarray):
        array: NDArray[np.float64] = value
        if array.dtype.kind != "f":
            return array
        if decimals is not None:
            array = np.round(array, decimals)
        return (
            array if np.isfinite(array).all() else [one if isfinite(one) else None for one in array.tolist()]
        )
    return value if isinstance(value, tuple | list) else [value] * count
