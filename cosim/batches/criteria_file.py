"""Reads a file of criteria for ``--criteria``, which holds ``[[criteria]]`` and nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from analysis.criteria.reading import EXAMPLE
from cosim.errors import InputError
from cosim.toml_files import read_toml


def tables_in(path: Path) -> list[dict[str, Any]]:
    """Return the criteria of a file for ``--criteria``, unchecked.

    Raises
    ------
    InputError
        If the file cannot be read or contains anything else.
    """
    content = read_toml(path, "--criteria")
    tables = content.pop("criteria", None)
    if content or not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise InputError(f"--criteria {path}: only [[criteria]] expected, for instance {EXAMPLE}")
    return tables
