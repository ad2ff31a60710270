"""Reads the description and single columns of the tables of a recorded run."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from analysis.files import read_json
from analysis.manifest import read_verified
from cosim.errors import InputError


def described(folder: Path) -> dict[str, Any]:
    """Return the content of ``run.json``.

    Raises
    ------
    InputError
        If the file is missing or cannot be read.
    """
    try:
        return read_json(folder / "run.json")
    except (OSError, ValueError) as error:
        raise InputError(f"{folder}: cannot be read as a run ({error})") from error


def columns(folder: Path, file: str, names: tuple[str, ...]) -> list[list[Any]]:
    """Return the named columns of a table, in this order; undefined values are ``None``.

    Raises
    ------
    InputError
        If the table cannot be read.
    """
    try:
        table = pq.read_table(io.BytesIO(read_verified(folder / file)), columns=list(names))
    except OSError as error:
        raise InputError(f"{folder / file}: cannot be read: {error.strerror or error}") from error
    return [table[name].to_pylist() for name in names]
