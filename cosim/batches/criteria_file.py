"""A file of criteria, as ``--criteria`` takes it: ``[[criteria]]`` and nothing else."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from analysis.criteria.reading import EXAMPLE
from cosim.errors import InputError


def tables_in(path: Path) -> list[dict[str, Any]]:
    """Return the criteria of a file for ``--criteria``, as it has them.

    Raises
    ------
    InputError
        If it cannot be read or has anything else in it.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"--criteria {path}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"--criteria {path}: not valid TOML: {error}") from error
    tables = content.pop("criteria", None)
    if content or not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise InputError(f"--criteria {path}: only [[criteria]] expected, for instance {EXAMPLE}")
    return tables
