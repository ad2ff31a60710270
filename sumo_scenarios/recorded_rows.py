"""Reads the rows of a CSV file of recorded positions."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sumo_scenarios.errors import ScenarioError

FloatArray: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Row:
    """One row of a file."""

    place: str
    """File and row, for messages."""
    numbers: tuple[float, ...]
    """Finite values of the numeric columns, in their order."""
    texts: Mapping[str, str]
    """Values of the text columns, by name and stripped; optional columns only if the file has them."""


def read_rows(
    path: Path, numbers: Sequence[str], texts: Sequence[str] = (), optional: Sequence[str] = ()
) -> Iterator[Row]:
    """Read the rows of a file.

    Parameters
    ----------
    path
        A CSV file with a header; other columns are ignored, and so is a byte-order mark.
    numbers, texts
        Columns that the file must have.
    optional
        Text columns that the file may have.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is missing, or a value is not a number; the message is one line.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file)
            header = [name.strip() for name in reader.fieldnames or ()]
            reader.fieldnames = header
            _check(path, header, [*texts, *numbers], optional)
            read = [*texts, *(name for name in optional if name in header)]
            for cells in reader:
                place = f"{path}, row {reader.line_num}"
                yield Row(
                    place,
                    tuple(_number(place, name, cells[name]) for name in numbers),
                    {name: (cells[name] or "").strip() for name in read},
                )
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{path}: no CSV file: {error}") from error


def _check(path: Path, header: Sequence[str], needed: Sequence[str], optional: Sequence[str]) -> None:
    missing = next((name for name in needed if name not in header), None)
    if missing is None:
        return
    expected = ", ".join(needed) + (f" and perhaps {', '.join(optional)}" if optional else "")
    raise ScenarioError(
        f"{path}: column '{missing}' is missing; expected {expected}, got {', '.join(header) or 'nothing'}"
    )


def _number(place: str, name: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a number") from None
    if not math.isfinite(value):
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a finite number")
    return value
