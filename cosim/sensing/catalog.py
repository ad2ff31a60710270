"""The sensing models by name: the files of ``cosim/sensing/models``; there is no list of them.

A model is a module with a class ``Model``. Its fields are the parameters, and ``sensor`` makes the sensor of
one ego. The first line of the module's docstring is the model's description.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Mapping
from functools import cache
from types import ModuleType
from typing import Any, cast

from pydantic import ValidationError

from controllers.parameters import Parameter, described_by, existing, told
from cosim.errors import InputError
from cosim.sensing import models
from cosim.sensing.interface import Sensing
from cosim.sensing.settings import Settings

PERFECT = "perfect"
"""The model that is used if none is requested."""


@cache
def names() -> tuple[str, ...]:
    """Return the names of all models, sorted."""
    return tuple(sorted(found.name for found in pkgutil.iter_modules(models.__path__)))


def describe(name: str) -> str:
    """Return the first line of the model's docstring."""
    return (inspect.getdoc(_module(name)) or "").partition("\n")[0]


def parameters(name: str) -> dict[str, Any]:
    """Return the model's parameters with their defaults."""
    return {one.name: one.default for one in described(name)}


def described(name: str) -> tuple[Parameter, ...]:
    """Return the full descriptions of the model's parameters."""
    return described_by(_model(name))


def having(key: str) -> tuple[str, ...]:
    """Return the models that have a parameter of that name."""
    return tuple(name for name in names() if key in parameters(name))


@cache
def all_parameters() -> frozenset[str]:
    """Return the names of the parameters of all models."""
    return frozenset(key for name in names() for key in parameters(name))


def build(name: str, values: Mapping[str, object]) -> Sensing:
    """Build a model.

    Parameters
    ----------
    name : one of ``names()``
    values : some of its parameters, as texts or as typed values; the others keep their defaults

    Raises
    ------
    InputError
        One line: unknown model or parameter, or a value of the wrong type or out of range.
    """
    try:
        return cast(Sensing, _model(name).model_validate(dict(values)))
    except ValidationError as error:
        raise InputError(f"sensing '{name}': {told(_model(name), error)}") from error


def values_of(sensing: Sensing) -> dict[str, Any]:
    """Return the present values of a model's parameters."""
    return cast(Settings, sensing).model_dump()


def _model(name: str) -> type[Settings]:
    return cast(type[Settings], _module(name).Model)


def _module(name: str) -> ModuleType:
    if name not in names():
        raise InputError(f"no sensing model '{name}'; {existing(name, names())}")
    return importlib.import_module(f"{models.__name__}.{name}")
