"""Controllers that a program hands over instead of a name: a function, a class, an object or a module."""

from __future__ import annotations

import copy
import hashlib
import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any, cast

from controllers.interface import Controller, Perception
from controllers.outside.functions import FromFunction
from controllers.outside.given import Given

EXPECTED = (
    "expected a name, a function of a perception, a class or a function build() that makes controllers, "
    "or an object with the methods decide and plan"
)


def given(thing: object) -> str | Given:
    """Return what a program hands over in the form that runs use; a name is returned as it is.

    Raises
    ------
    TypeError
        If it is nothing that could drive.
    """
    if isinstance(thing, str | Given):
        return thing
    name = _name(thing)
    if isinstance(thing, ModuleType):
        if not callable(getattr(thing, "build", None)):
            raise TypeError(f"module {name} has no function build(**parameters)")
        return Given(name, thing.build, _source(thing))
    if isinstance(thing, type):
        return Given(name, thing, _source(thing))
    if callable(getattr(thing, "decide", None)) and callable(getattr(thing, "plan", None)):
        # Every ego of every run gets its own object, as with controllers of the catalogue.
        return Given(name, lambda: cast(Controller, copy.deepcopy(thing)), _source(type(thing)))
    if not callable(thing):
        raise TypeError(f"controller {thing!r}: {EXPECTED}")
    needed = _needed(thing)
    if needed == 0:
        return Given(name, cast(Callable[..., Controller], thing), _source(thing))
    if needed == 1:
        function = cast(Callable[[Perception], object], thing)
        return Given(name, lambda: FromFunction(function), _source(thing))
    raise TypeError(f"controller {name} takes {needed} arguments: {EXPECTED}")


def _needed(function: Callable[..., object]) -> int:
    """Return how many positional arguments without a default a function has."""
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(
        one.kind in kinds and one.default is inspect.Parameter.empty
        for one in inspect.signature(function).parameters.values()
    )


def _name(thing: Any) -> str:
    name = str(getattr(thing, "__name__", type(thing).__name__))
    return "function" if name == "<lambda>" else name.rpartition(".")[2]


def _source(thing: Any) -> str:
    try:
        return hashlib.sha256(inspect.getsource(thing).encode()).hexdigest()
    except (OSError, TypeError):
        return ""  # typed at a prompt, or compiled
