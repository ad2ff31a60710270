"""Files in the formats of the tool; one that has its own name is always complete."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any

from analysis.manifest import read_verified

PART = ".part"
"""What the name of a file ends with until it is complete."""

_FORMULA = re.compile(r"[=+\-@\t\r\n＝＋－＠']")
"""How a text begins that a spreadsheet may take for a formula, or that begins with the mark itself."""
_NUMBER = re.compile(r"[+-]?\d+(\.\d*)?([eE][+-]?\d+)?")
_MARK = "'"
"""Put before such a text; a spreadsheet then shows the text, and executes nothing."""


@contextmanager
def completing(path: Path) -> Iterator[Path]:
    """Give a name to write a file under, and the file its own name when the block ends without an error.

    After an error the file of before is still there, and nothing of the new one.
    """
    part = path.with_name(path.name + PART)
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> Path:
    """Write a text and return its path."""
    with completing(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    return path


def write_json(path: Path, content: Mapping[str, Any]) -> Path:
    """Write JSON and return its path; a number that is not finite is a ``ValueError``, JSON has none."""
    return write_text(path, json_text(content))


def json_text(content: Mapping[str, Any]) -> str:
    """Return what `write_json` writes."""
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file.

    Raises
    ------
    DamageError
        When it has a hash and is not as it was written.
    OSError
        When it cannot be read.
    ValueError
        When it is truncated, not JSON, or no object.
    """
    content = json.loads(read_verified(path))
    if not isinstance(content, dict):
        raise ValueError(f"expected an object, found {type(content).__name__}")
    return content


def write_csv(path: Path, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> Path:
    """Write a table of comma-separated values and return its path."""
    with completing(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        file.writelines(csv_lines(chain([heads], rows)))
    return path


def csv_lines(rows: Iterable[Sequence[object]]) -> Iterator[str]:
    """Return the lines of a table of comma-separated values, in which no text is a formula."""
    writer = csv.writer(_Line(), lineterminator="\n")
    for row in rows:
        yield str(writer.writerow([harmless(cell) if isinstance(cell, str) else cell for cell in row]))


def read_csv(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table of comma-separated values, by the names of their columns.

    Raises
    ------
    DamageError
        When it has a hash and is not as it was written.
    OSError
        When it cannot be read.
    UnicodeDecodeError, csv.Error
        When it is no such table.
    """
    heads, *rows = read_csv_rows(path) or [[]]
    return [dict(zip(heads, row, strict=False)) for row in rows if row]


def read_csv_rows(path: Path) -> list[list[str]]:
    """Return all rows of a table of comma-separated values, the names of its columns first.

    Raises
    ------
    DamageError, OSError, UnicodeDecodeError, csv.Error
        As `read_csv`.
    """
    text = read_verified(path).decode("utf-8")
    return [[as_given(cell) for cell in row] for row in csv.reader(io.StringIO(text, newline=""))]


def harmless(text: str) -> str:
    """Return a text as a cell of a table in which spreadsheets find no formula; numbers stay as they are.

    >>> harmless("=1+1"), harmless("-0.5"), harmless("'tis")
    ("'=1+1", '-0.5', "''tis")
    """
    return _MARK + text if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def as_given(cell: str) -> str:
    """Return the text of which `harmless` has made a cell.

    >>> as_given("'=1+1"), as_given("-0.5")
    ('=1+1', '-0.5')
    """
    return cell.removeprefix(_MARK)


class _Line:
    """Takes the place of a file for :mod:`csv`, and gives the line back."""

    def write(self, text: str) -> str:
        return text
