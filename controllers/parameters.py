"""Descriptions of the parameters of a settings model, and one-line messages about invalid values."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from types import NoneType

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from controllers.annotations import alternatives, choices, metadata
from controllers.settings import SEED, OneOf, SettingsModel, Unit

_UNITS = {
    "m": "m",
    "s": "s",
    "ms": "ms",
    "mps": "m/s",
    "mps2": "m/s²",
    "mps3": "m/s³",
    "g": "g",
    "deg": "°",
    "hz": "Hz",
}
"""Units by the ending of a parameter's name, as the conventions require."""
_KINDS = {
    "float_parsing": "a number",
    "float_type": "a number",
    "int_parsing": "a whole number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_parsing": "true or false",
    "bool_type": "true or false",
    "string_type": "a text",
    "finite_number": "a finite number",
}
_BOUNDS = {"ge": "at least", "gt": "more than", "le": "at most", "lt": "less than"}
_PLAIN = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}


@dataclass(frozen=True, slots=True)
class Parameter:
    """One value that can be set."""

    name: str
    default: object
    unit: str
    """Unit; empty if it has none."""
    bounds: str
    """Allowed values, in words."""
    choices: tuple[str, ...]
    """The only texts allowed; empty if it is not restricted to a list of texts."""
    meaning: str


def described_by(model: type[SettingsModel]) -> tuple[Parameter, ...]:
    """Return the parameters that can be set, in the order of the model."""
    return tuple(
        Parameter(name, field.default, _unit(name, field), _bounds(field), _choices(field), _meaning(field))
        for name, field in model.model_fields.items()
        if name != SEED
    )


def told(model: type[SettingsModel], error: ValidationError) -> str:
    """Return in one line what was wrong with a value, and what would be valid."""
    first, *others = error.errors(include_url=False)
    key = str(first["loc"][0]) if first["loc"] else ""
    if first["type"] == "extra_forbidden":
        return unknown(model, key)
    if first["type"] == "value_error":
        text = str(first["msg"]).removeprefix("Value error, ")
        return f"{key}: {text}" if key else text
    field = model.model_fields[key]
    expected = [_expected(field, one) for one in (first, *others) if one["loc"][:1] == (key,)]
    if NoneType in alternatives(field.annotation):
        expected.append("none")
    return f"{key} = {first['input']!r}: expected {' or '.join(dict.fromkeys(expected))}"


def unknown(model: type[SettingsModel], key: str) -> str:
    """Return in one line that there is no such parameter, and which parameters there are."""
    if key in model.moved:
        return f"no parameter '{key}': {model.moved[key]}"
    names = tuple(one.name for one in described_by(model))
    return f"no parameter '{key}'; {existing(key, names) if names else 'it has none'}"


def existing(wanted: str, names: Iterable[str]) -> str:
    """Return the existing names in a sentence, with the one that the user may have meant.

    >>> existing("rang", ["hold", "range"])
    "did you mean 'range'? there are: hold, range"
    """
    names = list(names)
    close = difflib.get_close_matches(wanted, names, n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}there are: {', '.join(names)}"


def _expected(field: FieldInfo, details: ErrorDetails) -> str:
    kind, context = details["type"], details.get("ctx") or {}
    for bound, words in _BOUNDS.items():
        if bound in context:
            return f"{words} {context[bound]:g}"
    if kind in ("enum", "literal_error"):
        return _listed(_choices(field))
    return _KINDS.get(kind, str(details["msg"]))


def _unit(name: str, field: FieldInfo) -> str:
    said = [one.text for one in metadata(field) if isinstance(one, Unit)]
    return said[0] if said else _UNITS.get(name.rpartition("_")[2] if "_" in name else "", "")


def _meaning(field: FieldInfo) -> str:
    return re.sub(r"\s+", " ", field.description or "").replace("``", "").strip()


def _choices(field: FieldInfo) -> tuple[str, ...]:
    for one in metadata(field):
        if isinstance(one, OneOf):
            return one.names()
    return choices(field)


def _bounds(field: FieldInfo) -> str:
    kinds = [kind for kind in alternatives(field.annotation) if kind is not NoneType]
    limits = [
        f"{words} {getattr(one, bound):g}"
        for one in metadata(field)
        for bound, words in _BOUNDS.items()
        if getattr(one, bound, None) is not None
    ]
    if limits:
        named = ["a whole number, " * (int in kinds) + " and ".join(limits)]
    else:
        named = [_PLAIN.get(kind, kind.__name__) for kind in kinds if isinstance(kind, type)]
    what = _listed(_choices(field)) or " or ".join(named)
    return f"{what} or none" if NoneType in alternatives(field.annotation) else what


def _listed(texts: tuple[str, ...]) -> str:
    *others, last = (f"'{text}'" for text in texts) if texts else ("",)
    return f"{', '.join(others)} or {last}" if others else last
