"""Declaration of a column: name, type, unit, meaning, and the source of its values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    name: str
    kind: str
    """``string``, ``integer``, ``number``, ``boolean`` (0 or 1 in a CSV file) or ``numbers`` (a list)."""
    unit: str
    """Unit; empty for texts and names."""
    description: str
    source: str = ""
    """Attributes or keys, joined by dots, that lead from a row's object to the value; empty if the values are
    given by name, as by metrics."""
    choices: tuple[str, ...] = ()
    minimum: float | None = None
    required: bool = False
    """Whether the value must be defined."""
    worse: str = ""
    """For a metric's column in runs.csv: which direction is worse, if it differs from the metric's."""
    maximum: float | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """One CSV file."""

    name: str
    description: str
    columns: tuple[Column, ...]
    key: tuple[str, ...]

    @property
    def file(self) -> str:
        """Name of the file."""
        return f"{self.name}.csv"

    def names(self) -> tuple[str, ...]:
        """Return the names of the columns, in order."""
        return tuple(column.name for column in self.columns)


def text(name: str, description: str, *choices: str, source: str = "", required: bool = False) -> Column:
    """Declare a column of texts; if there are choices, only these occur."""
    return Column(name, "string", "", description, source, choices, required=required)


def count(
    name: str, description: str, *, source: str = "", required: bool = False, worse: str = ""
) -> Column:
    """Declare a column of counts."""
    return Column(name, "integer", "1", description, source, minimum=0.0, required=required, worse=worse)


def flag(name: str, description: str, *, source: str = "", required: bool = False) -> Column:
    """Declare a column of yes or no."""
    return Column(name, "boolean", "1", description, source, required=required)


def at_least_0(
    name: str, unit: str, description: str, *, source: str = "", required: bool = False, worse: str = ""
) -> Column:
    """Declare a column of numbers that cannot be negative."""
    return Column(name, "number", unit, description, source, minimum=0.0, required=required, worse=worse)


def share(name: str, description: str, *, source: str = "", required: bool = False) -> Column:
    """Declare a column of numbers from 0 to 1: shares and probabilities."""
    return Column(name, "number", "1", description, source, minimum=0.0, required=required, maximum=1.0)


def number(name: str, unit: str, description: str, *, source: str = "", required: bool = False) -> Column:
    """Declare a column of numbers of either sign."""
    return Column(name, "number", unit, description, source, required=required)


@cache
def follow(source: str) -> Callable[[Any], Any]:
    """Return a function from a row's object to the value that a column's source names.

    The value is ``None`` if one on the way is ``None`` or a key is missing.

    Examples
    --------
    >>> follow("meta.seed")({"meta": {"seed": 7}})
    7
    >>> follow("plan.status")({"plan": None}) is None
    True
    """
    names = source.split(".")

    def value_of(made_of: Any) -> Any:
        value = made_of
        for name in names:
            value = value.get(name) if isinstance(value, dict) else getattr(value, name)
            if value is None:
                return None
        return value

    return value_of


def row_of(columns: tuple[Column, ...], made_of: Any) -> dict[str, Any]:
    """Return the values of the columns that have a source, by name."""
    return {column.name: follow(column.source)(made_of) for column in columns if column.source}
