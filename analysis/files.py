"""Reads and writes files of the tool; a file under its final name is always complete."""

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
"""Ending of a file's name until the file is complete."""

_FORMULA = re.compile(r"[=+\-@\t\r\n＝＋－＠']")
"""Beginning of a text that a spreadsheet may read as a formula, or that already begins with the mark."""
_NUMBER = re.compile(r"[+-]?\d+(\.\d*)?([eE][+-]?\d+)?")
_MARK = "'"
"""Mark put before such a text, so that a spreadsheet shows it and executes nothing."""


@contextmanager
def completing(path: Path) -> Iterator[Path]:
    """Yield a temporary name for a file; the file gets its own name if the block ends without an error.

    After an error, the previous file is still there and nothing remains of the new one.
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
    """Write JSON and return its path; numbers that are not finite raise ``ValueError``, as JSON has none."""
    return write_text(path, json_text(content))


def json_text(content: Mapping[str, Any]) -> str:
    """Return the text that `write_json` writes."""
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file.

    Raises
    ------
    DamageError
        If the file has a hash and was altered since.
    OSError
        If it cannot be read.
    ValueError
        If it is truncated, is not JSON, or holds no object.
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
    """Yield the lines of a table of comma-separated values, in which no text is read as a formula."""
    writer = csv.writer(_Line(), lineterminator="\n")
    for row in rows:
        yield str(writer.writerow([harmless(cell) if isinstance(cell, str) else cell for cell in row]))


def read_csv(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table of comma-separated values, by column name.

    Raises
    ------
    DamageError
        If the file has a hash and was altered since.
    OSError
        If it cannot be read.
    UnicodeDecodeError, csv.Error
        If it is not such a table.
    """
    heads, *rows = read_csv_rows(path) or [[]]
    return [dict(zip(heads, row, strict=False)) for row in rows if row]


def read_csv_rows(path: Path) -> list[list[str]]:
    """Return all rows of a table of comma-separated values, beginning with the names of its columns.

    Raises
    ------
    DamageError, OSError, UnicodeDecodeError, csv.Error
        As for `read_csv`.
    """
    text = read_verified(path).decode("utf-8")
    return [[as_given(cell) for cell in row] for row in csv.reader(io.StringIO(text, newline=""))]


def harmless(text: str) -> str:
    """Return a text as a cell that spreadsheets do not read as a formula; numbers stay unchanged.

    >>> harmless("=1+1"), harmless("-0.5"), harmless("'tis")
    ("'=1+1", '-0.5', "''tis")
    """
    return _MARK + text if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def as_given(cell: str) -> str:
    """Return the original text of a cell made by `harmless`.

    >>> as_given("'=1+1"), as_given("-0.5")
    ('=1+1', '-0.5')
    """
    return cell.removeprefix(_MARK)


class _Line:
    """Stands in for a file in :mod:`csv`, and returns each line."""

    def write(self, text: str) -> str:
        return text
