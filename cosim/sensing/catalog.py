"""The sensing models that exist, by name: files of ``cosim/sensing/models``, none listed anywhere.

A model is a module with a class ``Model``: its fields are the parameters, ``sensor`` makes the sensor of
one ego. The first line of the module's docstring is its description.
"""

from __future__ import annotations

import difflib
import importlib
import inspect
import pkgutil
from collections.abc import Iterable, Mapping
from functools import cache
from types import ModuleType
from typing import Any, cast

from pydantic import ValidationError

from cosim.errors import InputError
from cosim.sensing import models
from cosim.sensing.interface import Sensing
from cosim.sensing.settings import Settings

PERFECT = "perfect"
"""The model of whoever asks for none."""

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


@cache
def names() -> tuple[str, ...]:
    """Return the names of all models, sorted."""
    return tuple(sorted(found.name for found in pkgutil.iter_modules(models.__path__)))


def describe(name: str) -> str:
    """Return the first line of the model's docstring."""
    return (inspect.getdoc(_module(name)) or "").partition("\n")[0]


def parameters(name: str) -> dict[str, Any]:
    """Return the model's parameters with their defaults."""
    return {key: field.default for key, field in _model(name).model_fields.items()}


@cache
def all_parameters() -> frozenset[str]:
    """Return the names of the parameters of any model."""
    return frozenset(key for name in names() for key in parameters(name))


def build(name: str, values: Mapping[str, object]) -> Sensing:
    """Build a model.

    Parameters
    ----------
    name : one of ``names()``
    values : some of its parameters, as texts or as what they are; the others keep their defaults

    Raises
    ------
    InputError
        One line: unknown model or parameter, or a value of the wrong type or out of range.
    """
    try:
        return cast(Sensing, _model(name).model_validate(dict(values)))
    except ValidationError as error:
        raise InputError(f"sensing '{name}': {_told(name, error)}") from error


def values_of(sensing: Sensing) -> dict[str, Any]:
    """Return the present values of a model's parameters."""
    return cast(Settings, sensing).model_dump()


def _model(name: str) -> type[Settings]:
    return cast(type[Settings], _module(name).Model)


def _module(name: str) -> ModuleType:
    if name not in names():
        raise InputError(f"no sensing model '{name}'; {_existing(name, names())}")
    return importlib.import_module(f"{models.__name__}.{name}")


def _told(name: str, error: ValidationError) -> str:
    details = error.errors(include_url=False)[0]
    key, kind = ".".join(map(str, details["loc"])), details["type"]
    if kind == "extra_forbidden":
        existing = tuple(parameters(name))
        return f"no parameter '{key}'; {_existing(key, existing) if existing else 'it has none'}"
    if kind == "value_error":
        text = str(details["msg"]).removeprefix("Value error, ")
        return f"{key}: {text}" if key else text
    expected = _KINDS.get(kind, kind)
    for bound, words in _BOUNDS.items():
        if bound in (details.get("ctx") or {}):
            expected = f"{words} {details['ctx'][bound]:g}"
    return f"{key} = {details['input']!r}: expected {expected}"


def _existing(wanted: str, existing: Iterable[str]) -> str:
    close = difflib.get_close_matches(wanted, list(existing), n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}there are: {', '.join(existing)}"
