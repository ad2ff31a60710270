"""The controllers that exist, by name: files of ``controllers/strategies`` and plug-ins.

A controller is a module with ``build(settings: Settings) -> Controller``, where ``Settings`` is a subclass of
:class:`~controllers.settings.ControllerSettings`, or with ``build(*, parameter: type = default, ...)``, whose
signature gives the settings. The first line of the module's docstring is its description. Modules outside
this repository join through the entry-point group ``cosim.controllers``, are named by their address
(``./patient.py``), or are passed by a program (:mod:`controllers.outside.handed_over`).
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from importlib.metadata import EntryPoints, entry_points
from pathlib import Path
from typing import Any, cast

from pydantic import ValidationError

import controllers.strategies
from controllers import settings
from controllers.interface import Controller
from controllers.outside import addresses
from controllers.outside.addresses import AddressError, Found
from controllers.outside.given import Given
from controllers.parameters import Parameter, described_by, existing, told, unknown
from controllers.settings import SEED, ControllerSettings

ENTRY_POINT_GROUP = "cosim.controllers"
Named = str | Given
"""A name, an address, or a controller that a program passes."""


class CatalogError(ValueError):
    """An unknown controller or parameter, or an invalid value; the text is one line for the user."""


def names() -> tuple[str, ...]:
    """Return the names of all controllers, sorted."""
    return tuple(sorted(_own() | _plug_ins().names))


def describe(name: Named) -> str:
    """Return the first line of the controller's docstring."""
    module = _module(name)
    documentation = module.documentation if isinstance(module, Found) else inspect.getdoc(module)
    return inspect.cleandoc(documentation or "").partition("\n")[0]


def model_of(name: Named) -> type[ControllerSettings]:
    """Return the model of the controller's settings.

    Raises
    ------
    CatalogError
        There is no such controller, or it cannot be loaded.
    """
    try:
        return settings.model_of(_module(name).build)
    except (TypeError, NameError) as error:
        raise CatalogError(f"controller '{name}': {error}") from error


def parameters(name: Named) -> Mapping[str, object]:
    """Return the controller's parameters with their defaults, in the order of its settings."""
    return {one.name: one.default for one in described(name)}


def described(name: Named) -> tuple[Parameter, ...]:
    """Return the full descriptions of the controller's parameters."""
    return described_by(model_of(name))


def moved(name: Named) -> Mapping[str, str]:
    """Return the controller's former parameters: for each, what to do instead."""
    return model_of(name).moved


def having(key: str) -> tuple[str, ...]:
    """Return the names of the controllers with that parameter, among those that can be loaded."""
    found = []
    for name in names():
        with suppress(CatalogError):
            found += [name] if key in parameters(name) else []
    return tuple(found)


def parse(name: Named, texts: Mapping[str, str]) -> dict[str, object]:
    """Convert the texts of parameters to the types of the controller's settings.

    Raises
    ------
    CatalogError
        Unknown controller or parameter, or a text that is not a valid value.
    """
    made = _settings(name, texts)
    return {key: getattr(made, key) for key in texts}


def build(name: Named, /, *, seed: int = 1, **values: object) -> Controller:
    """Build a controller for one run.

    Parameters
    ----------
    name : str or Given
        One of ``names()``, an address, or a controller that a program passes.
    seed : int
        Seed for controllers that draw random numbers.
    **values
        Some of ``parameters(name)``; the others keep their defaults.

    Raises
    ------
    CatalogError
        Unknown controller or parameter, or a value of the wrong type or out of range.
    """
    made = _settings(name, values).model_copy(update={SEED: seed})
    try:
        return cast(Controller, settings.call(_module(name).build, made))
    except ValueError as error:
        raise CatalogError(f"controller '{name}': {' '.join(str(error).split())}") from error
    except (Exception, SystemExit) as error:  # a plug-in may raise anything
        raise CatalogError(f"controller '{name}' cannot be built: {_told_of(error)}") from error


def _told_of(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


def _settings(name: Named, values: Mapping[str, object]) -> ControllerSettings:
    model = model_of(name)
    if SEED in values:
        raise CatalogError(f"controller '{name}': {unknown(model, SEED)}")
    try:
        return model.model_validate(dict(values))
    except ValidationError as error:
        raise CatalogError(f"controller '{name}': {told(model, error)}") from error


def _own() -> set[str]:
    """Return the names of the repository's own controllers, which no plug-in of the same name replaces."""
    return {found.name for found in pkgutil.iter_modules(controllers.strategies.__path__)}


def _plug_ins() -> EntryPoints:
    return _announced(tuple((place, _changed_at(place)) for place in sys.path))


@lru_cache(maxsize=1)
def _announced(places: tuple[tuple[str, float], ...]) -> EntryPoints:
    """Return the entry points of the packages in these places.

    Reading the entry points of all installed packages takes 20 ms; a run needs them a dozen times, and once
    more for each ego that departs.
    """
    return entry_points(group=ENTRY_POINT_GROUP)


def _changed_at(place: str) -> float:
    """Return when something was last installed in a folder, or removed from it."""
    try:
        return Path(place).stat().st_mtime
    except OSError:
        return 0.0  # an archive, or nothing at all


def files(name: Named) -> dict[str, str]:
    """Return the files of a controller from outside the catalogue, and their SHA-256."""
    if isinstance(name, Given):
        return {f"controller {name}": name.source_sha256} if name.source_sha256 else {}
    return addresses.files(name)


def _module(name: Named) -> Any:
    """Return the module or object with the controller's function ``build``."""
    if isinstance(name, Given):
        return name
    own, points = _own(), _plug_ins()
    there = name in own or name in points.names or addresses.is_address(name)
    if not there:
        raise CatalogError(f"no controller '{name}'; {existing(name, names())}")
    module: Any
    try:
        if name in own:
            module = importlib.import_module(f"{controllers.strategies.__name__}.{name}")
        elif name in points.names:
            module = points[name].load()
        else:
            module = addresses.find(name)
    except AddressError as error:
        raise CatalogError(str(error)) from error
    except ImportError as error:
        raise CatalogError(f"controller '{name}' cannot be loaded: {error}") from error
    except (Exception, SystemExit) as error:  # a plug-in may raise anything
        raise CatalogError(f"controller '{name}' cannot be loaded: {_told_of(error)}") from error
    if not callable(getattr(module, "build", None)):
        raise CatalogError(f"controller '{name}' has no function build(**parameters)")
    return module
