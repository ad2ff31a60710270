"""Reads and writes attributes of SUMO's types by class of road users, from calibrations and scenarios."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

from analysis.errors import did_you_mean
from cosim.errors import InputError
from cosim.tracks.lanes import SUMO_CLASS
from cosim.validation.demand import Types

TABLE = "types"


def read_types(path: Path | None) -> Types:
    """Return the attributes of types in a file; empty without a file.

    Raises
    ------
    InputError
        If the file cannot be read, or names an unknown class.
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


def types_of_classes(path: Path | None) -> Types:
    """Return the attributes of the types in a file of SUMO by their classes; empty without a file.

    Raises
    ------
    InputError
        If two types have the same class, as it is not known which of them a recorded road user has.
    """
    if path is None:
        return {}
    kinds = {sumo: kind for kind, sumo in SUMO_CLASS.items()}
    types: dict[str, dict[str, str]] = {}
    for element in ElementTree.parse(path).getroot().iter("vType"):
        attributes = {key: value for key, value in element.items() if key not in ("id", "vClass")}
        kind = kinds.get(element.get("vClass", "passenger"))
        if kind in types:
            raise InputError(
                f"{path}: several types of class {SUMO_CLASS[kind]}; expected one for each class"
            )
        if kind is not None:
            types[kind] = attributes
    return types


def types_text(types: Types, comments: Mapping[str, str]) -> str:
    """Return the text of a file that `read_types` reads.

    Parameters
    ----------
    types
    comments : comments by ``class.attribute``
    """
    lines = []
    for kind, attributes in types.items():
        lines += ["", f"[{TABLE}.{kind}]"]
        for key, value in attributes.items():
            told = comments.get(f"{kind}.{key}")
            lines.append(f'{key} = "{value}"' + (f" # {told}" if told else ""))
    return "\n".join(lines).lstrip("\n") + "\n"
