"""Attributes of SUMO's types by class of road users, as a TOML file: what a calibration writes."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

from analysis.errors import did_you_mean
from cosim.errors import InputError
from cosim.tracks.lanes import SUMO_CLASS
from cosim.validation.demand import Types

TABLE = "types"


def read_types(path: Path | None) -> Types:
    """Return the attributes of types in a file; none without a file.

    Raises
    ------
    InputError
        If it cannot be read, or names an unknown class.
    """
    if path is None:
        return {}
    try:
        content = tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from error
    tables = content.get(TABLE)
    if not isinstance(tables, dict) or not all(isinstance(one, dict) for one in tables.values()):
        raise InputError(f"{path}: expected tables [{TABLE}.car], [{TABLE}.pedestrian] and so on")
    for kind in tables:
        if kind not in SUMO_CLASS:
            hint = did_you_mean(kind, SUMO_CLASS)
            raise InputError(f"{path}: unknown class {kind!r}; {hint}there are {', '.join(SUMO_CLASS)}")
    return {kind: {key: str(value) for key, value in one.items()} for kind, one in tables.items()}


def types_text(types: Types, comments: Mapping[str, str]) -> str:
    """Return the text of such a file.

    Parameters
    ----------
    types
    comments : by ``class.attribute``
    """
    lines = []
    for kind, attributes in types.items():
        lines += ["", f"[{TABLE}.{kind}]"]
        for key, value in attributes.items():
            told = comments.get(f"{kind}.{key}")
            lines.append(f'{key} = "{value}"' + (f" # {told}" if told else ""))
    return "\n".join(lines).lstrip("\n") + "\n"
