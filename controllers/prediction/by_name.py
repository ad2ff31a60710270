"""Predictors by name: the files of this folder that have a ``build()``."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from types import ModuleType
from typing import Annotated, cast

import controllers.prediction
from controllers.prediction.forecast import Predictor
from controllers.settings import OneOf

CONSTANT_VELOCITY = "constant_velocity"
_SELF = "by_name"


def names() -> tuple[str, ...]:
    """Return the names of all predictors, sorted."""
    found = {module.name for module in pkgutil.iter_modules(controllers.prediction.__path__)}
    builders = [name for name in found - {_SELF} if callable(getattr(_module(name), "build", None))]
    return tuple(sorted(builders))


def build(name: str, *, seed: int = 1) -> Predictor:
    """Build a predictor for one ego.

    Parameters
    ----------
    name : one of ``names()``
    seed : seed for predictors that draw random numbers

    Raises
    ------
    ValueError
        Unknown name.
    """
    if name not in names():
        raise ValueError(f"predictor = '{name}' is none of {', '.join(names())}")
    module = _module(name)
    given = {"seed": seed} if "seed" in inspect.signature(module.build).parameters else {}
    return cast(Predictor, module.build(**given))


def sampled(name: str, *, seed: int = 1) -> Predictor | None:
    """Return a predictor, but ``None`` for constant velocities, which some controllers treat in closed form.

    Parameters
    ----------
    name, seed : as for :func:`build`
    """
    predictor = build(name, seed=seed)
    return None if name == CONSTANT_VELOCITY else predictor


def _module(name: str) -> ModuleType:
    return importlib.import_module(f"{controllers.prediction.__name__}.{name}")


PredictorName = Annotated[str, OneOf(names)]
"""The name of a predictor as a parameter of a controller."""
