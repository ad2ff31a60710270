"""The texts of a CSV file: undefined values are empty cells, booleans are 0 or 1."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import isfinite
from typing import Any

import numpy as np

from analysis.tables.column import Column, Table

Row = Mapping[str, Any]


def plain(table: Table, row: Row) -> dict[str, Any]:
    """Return the row with the table's types, and ``None`` for undefined values."""
    known = {}
    for name, value in row.items():
        if isinstance(value, np.generic):
            value = value.item()
        known[name] = None if isinstance(value, float) and not isfinite(value) else value
    for column in table.columns:
        if column.kind == "boolean" and known.get(column.name) is not None:
            known[column.name] = bool(known[column.name])
    return known


def decimals(value: float) -> str:
    """Return a number with at most six decimals."""
    return f"{value:.6f}".rstrip("0").rstrip(".")


def cells(table: Table, rows: Iterable[Row], number: Callable[[float], str] = decimals) -> list[list[str]]:
    """Return the texts of a CSV file, without its header; arguments and errors as for :func:`cell_rows`."""
    return list(cell_rows(table, rows, number))


def cell_rows(
    table: Table, rows: Iterable[Row], number: Callable[[float], str] = decimals
) -> Iterator[list[str]]:
    """Yield the texts of a CSV file row by row, without its header.

    Parameters
    ----------
    table, rows
        Table and rows to write.
    number
        Makes the text of a value in a column of numbers.

    Raises
    ------
    KeyError
        If a value belongs to no column of the table.
    ValueError
        If a required value is undefined.
    """
    known = set(table.names())
    for row in rows:
        if foreign := set(row) - known:
            raise KeyError(f"{table.file} has no column {sorted(foreign)}")
        yield [_cell(table, column, row.get(column.name), number) for column in table.columns]


def _cell(table: Table, column: Column, value: Any, number: Callable[[float], str]) -> str:
    if value is None:
        if column.required:
            raise ValueError(f"{table.file}: column {column.name} must not be empty")
        return ""
    if column.kind == "boolean":
        return "1" if value else "0"
    if column.kind == "integer":
        return str(int(value))
    if column.kind == "number":
        text = number(float(value))
        return "0" if text == "-0" else text
    return str(value)
