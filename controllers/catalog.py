"""The controllers that exist, by name: files of ``controllers/strategies`` and plug-ins.

A controller is a module with ``build(*, parameter: type = default, ...) -> Controller``; the signature is
the list of parameters, the first line of the module's docstring its description. Modules outside this
repository join through the entry-point group ``cosim.controllers``. A ``build`` that needs random numbers
also takes ``seed``.
"""

from __future__ import annotations

import difflib
import importlib
import inspect
import math
import pkgutil
import types
from collections.abc import Iterable, Mapping
from importlib.metadata import entry_points
from types import ModuleType
from typing import Literal, Union, cast, get_args, get_origin, get_type_hints

import controllers.strategies
from controllers.interface import Controller

ENTRY_POINT_GROUP = "cosim.controllers"
SEED = "seed"

_TRUTH = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
_PLAIN = {bool: "true or false", int: "a whole number", float: "a number", str: "a text", type(None): "none"}


class CatalogError(ValueError):
    """An unknown controller or parameter, or a value it cannot take; the text is one line for the user."""


def names() -> tuple[str, ...]:
    """Return the names of all controllers, sorted."""
    return tuple(sorted(_own() | {point.name for point in entry_points(group=ENTRY_POINT_GROUP)}))


def describe(name: str) -> str:
    """Return the first line of the controller's docstring."""
    documentation = inspect.getdoc(_module(name)) or ""
    return documentation.partition("\n")[0]


def parameters(name: str) -> Mapping[str, object]:
    """Return the controller's parameters with their defaults, in the order of its signature."""
    return {key: value.default for key, value in _signature(name).items() if key != SEED}


def parse(name: str, texts: Mapping[str, str]) -> dict[str, object]:
    """Convert the texts of parameters to what the controller's signature asks for.

    Raises
    ------
    CatalogError
        Unknown controller or parameter, or a text that is no such value.
    """
    kinds = _kinds(name, texts)
    return {key: _from_text(name, key, text.strip(), kinds[key]) for key, text in texts.items()}


def build(name: str, /, *, seed: int = 1, **values: object) -> Controller:
    """Build a controller for one run.

    Parameters
    ----------
    name : str
        One of ``names()``.
    seed : int
        Handed on where the controller draws random numbers.
    **values
        Some of ``parameters(name)``; the others keep their defaults.

    Raises
    ------
    CatalogError
        Unknown controller or parameter, or a value of the wrong type or out of range.
    """
    kinds = _kinds(name, values)
    given = {key: _checked(name, key, value, kinds[key]) for key, value in values.items()}
    if SEED in _signature(name):
        given[SEED] = seed
    try:
        return cast(Controller, _module(name).build(**given))
    except ValueError as error:
        raise CatalogError(f"controller '{name}': {error}") from error


def _own() -> set[str]:
    """Return the files of the repository, which a plug-in of the same name does not replace."""
    return {found.name for found in pkgutil.iter_modules(controllers.strategies.__path__)}


def _module(name: str) -> ModuleType:
    if name not in names():
        raise CatalogError(f"no controller '{name}'; {_existing(name, names())}")
    module: ModuleType
    try:
        if name in _own():
            module = importlib.import_module(f"{controllers.strategies.__name__}.{name}")
        else:
            module = next(iter(entry_points(group=ENTRY_POINT_GROUP, name=name))).load()
    except ImportError as error:
        raise CatalogError(f"controller '{name}' cannot be loaded: {error}") from error
    if not callable(getattr(module, "build", None)):
        raise CatalogError(f"controller '{name}' has no function build(**parameters)")
    return module


def _signature(name: str) -> dict[str, inspect.Parameter]:
    found = inspect.signature(_module(name).build).parameters
    bare = [key for key, value in found.items() if value.default is inspect.Parameter.empty]
    if bare:
        raise CatalogError(f"controller '{name}': parameter '{bare[0]}' of build has no default")
    return dict(found)


def _kinds(name: str, wanted: Iterable[str]) -> dict[str, tuple[object, ...]]:
    """Return the types that each parameter may have, refusing names that do not exist."""
    defaults = parameters(name)
    for key in wanted:
        if key not in defaults:
            what = _existing(key, tuple(defaults)) if defaults else "it has no parameters"
            raise CatalogError(f"controller '{name}' has no parameter '{key}'; {what}")
    hints = get_type_hints(_module(name).build)
    return {key: _alternatives(hints.get(key, type(value))) for key, value in defaults.items()}


def _alternatives(hint: object) -> tuple[object, ...]:
    """Return what a hint is made of: ``float | None`` gives both, ``Literal`` its values."""
    if get_origin(hint) in (Union, types.UnionType):
        return tuple(part for one in get_args(hint) for part in _alternatives(one))
    if get_origin(hint) is Literal:
        return get_args(hint)
    return (hint,)


def _from_text(name: str, key: str, text: str, kinds: tuple[object, ...]) -> object:
    if type(None) in kinds and text.lower() in ("", "none"):
        return None
    for kind in kinds:
        if isinstance(kind, str) and text == kind:
            return text
        if kind is bool and text.lower() in _TRUTH:
            return _TRUTH[text.lower()]
        if kind in (int, float):
            try:
                number = int(text) if kind is int else float(text)
            except ValueError:
                continue
            if not math.isnan(number):
                return number
        elif isinstance(kind, type) and issubclass(kind, str):
            return _checked(name, key, text, kinds)
    raise _wrong(name, key, text, kinds)


def _checked(name: str, key: str, value: object, kinds: tuple[object, ...]) -> object:
    """Return the value as the kind it stands for; an int is accepted as a float, a text as its StrEnum."""
    for kind in kinds:
        if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
            if not math.isnan(value):
                return float(value)
        elif kind is int and isinstance(value, bool):
            continue
        elif (isinstance(kind, type) and isinstance(value, kind)) or (
            isinstance(kind, str) and value == kind
        ):
            return value
        elif isinstance(kind, type) and issubclass(kind, str) and isinstance(value, str):
            try:
                return kind(value)
            except ValueError:
                continue
    raise _wrong(name, key, value, kinds)


def _wrong(name: str, key: str, value: object, kinds: tuple[object, ...]) -> CatalogError:
    return CatalogError(
        f"controller '{name}': {key} = {value!r} is not {' or '.join(_kind_name(kind) for kind in kinds)}"
    )


def _kind_name(kind: object) -> str:
    if isinstance(kind, str):
        return f"'{kind}'"
    if not isinstance(kind, type):
        return str(kind)
    members = getattr(kind, "__members__", {})
    return " or ".join(f"'{member}'" for member in members.values()) or _PLAIN.get(kind, kind.__name__)


def _existing(wanted: str, existing: tuple[str, ...]) -> str:
    close = difflib.get_close_matches(wanted, existing, n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}there are: {', '.join(existing)}"
