"""Files in the formats of the tool; one that has its own name is always complete."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from analysis.manifest import read_verified

PART = ".part"
"""What the name of a file ends with until it is complete."""


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
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
    return path


def read_csv(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table of comma-separated values.

    Raises
    ------
    DamageError
        When it has a hash and is not as it was written.
    OSError
        When it cannot be read.
    UnicodeDecodeError, csv.Error
        When it is no such table.
    """
    text = read_verified(path).decode("utf-8")
    return list(csv.DictReader(io.StringIO(text, newline="")))
