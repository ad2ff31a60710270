"""Tables with one row, numbered from 1, for each overlap or vehicle conflict of a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from analysis.results.origin import Origin
from analysis.tables.cells import Row, plain
from analysis.tables.column import Column, Table, row_of


@dataclass(frozen=True, slots=True)
class Numbered:
    """The content of a row."""

    origin: Origin
    number: int
    """Within the run, from 1."""
    what: object
    """Columns of the table refer to its attributes as ``what.name``."""


def number_within_run(name: str) -> Column:
    """Return the column for the number of a row."""
    return Column(name, "integer", "1", "number within the run, from 1", "number", minimum=1.0, required=True)


def numbered_rows(table: Table, origin: Origin, things: Iterable[object]) -> Sequence[Row]:
    """Return the rows of a table, in the order of the things."""
    return [
        plain(table, row_of(table.columns, Numbered(origin, number, one)))
        for number, one in enumerate(things, start=1)
    ]
