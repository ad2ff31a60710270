"""Predictors by name: the files of this folder that have a ``build()``."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from typing import cast

import controllers.prediction
from controllers.prediction.forecast import Predictor

_NOT_PREDICTORS = frozenset({"contact", "forecast", "named"})


def names() -> tuple[str, ...]:
    """Return the names of all predictors, sorted."""
    found = {module.name for module in pkgutil.iter_modules(controllers.prediction.__path__)}
    return tuple(sorted(found - _NOT_PREDICTORS))


def build(name: str, *, seed: int = 1) -> Predictor:
    """Build a predictor for one ego.

    Parameters
    ----------
    name : one of ``names()``
    seed : handed on where the predictor draws random numbers

    Raises
    ------
    ValueError
        Unknown name.
    """
    if name not in names():
        raise ValueError(f"predictor = '{name}' is none of {', '.join(names())}")
    module = importlib.import_module(f"{controllers.prediction.__name__}.{name}")
    given = {"seed": seed} if "seed" in inspect.signature(module.build).parameters else {}
    return cast(Predictor, module.build(**given))
