"""Reading of TOML files that users write by hand."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from cosim.errors import InputError


def read_toml(path: Path, flag: str = "") -> dict[str, Any]:
    """Return the content of a TOML file; messages name the flag with which the user gave it.

    Raises
    ------
    InputError
        If the file cannot be read or is not valid TOML.
    """
    where = f"{flag} {path}".lstrip()
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{where}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{where}: not valid TOML: {error}") from error
