"""A controller that a program hands over: a function, a class, an object or a module instead of a name."""

from __future__ import annotations

import copy
import hashlib
import inspect
import numbers
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any, cast

import numpy as np

from controllers.driving import lane_keeping
from controllers.interface import (
    Command,
    Controller,
    Decision,
    Manoeuvre,
    Perception,
    Plan,
    constant_command,
)

EXPECTED = (
    "expected a name, a function of a perception, a class or a function build() that makes controllers, "
    "or an object with the methods decide and plan"
)


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """A controller without an entry in the catalogue; its text is its name."""

    name: str
    build: Callable[..., Controller]
    """Makes a controller for one ego and one run; its parameters have defaults."""
    source_sha256: str = ""
    """Hash of its source; empty where Python does not know the source."""

    def __str__(self) -> str:
        return self.name


@dataclass(slots=True)
class FromFunction:
    """Asks a function what to do; it keeps the lane unless the function steers."""

    function: Callable[[Perception], object]

    def decide(self, perception: Perception) -> Decision:
        """Keep the lane: what the function wants shows in its command."""
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return what the function answers as a plan."""
        return plan_of(self.function(perception), perception)


def plan_of(answer: object, perception: Perception) -> Plan:
    """Return an answer as a plan.

    Parameters
    ----------
    answer
        A plan, a command, an acceleration [m/s^2], or an acceleration and a front-wheel angle [rad];
        without an angle the ego keeps its lane.
    perception
        What was answered to.

    Raises
    ------
    TypeError
        For anything else.
    """
    if isinstance(answer, Plan):
        return answer
    if isinstance(answer, Command):
        return Plan(answer)
    values = np.ravel(np.asarray(answer)) if _is_numeric(answer) else np.zeros(0)
    if len(values) not in (1, 2):
        raise TypeError(
            "expected a Plan, a Command, an acceleration, or an acceleration and a steering angle; "
            f"got {type(answer).__name__}"
        )
    if not np.isfinite(values).all():
        return Plan(constant_command(float(values[0]), float(values[-1])))  # told by who checks all commands
    times = lane_keeping.instants(perception.ego)
    acceleration = np.full(len(times), float(values[0]))
    if len(values) == 2:
        steering = np.full(len(times), float(values[1]))
    else:
        steering = lane_keeping.steering(perception, 0.0, acceleration)
    return Plan(Command(times, acceleration, steering))


def given(thing: object) -> str | Given:
    """Return what a program hands over as something that runs can be made of; a name as it is.

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
        # Every ego of every run has an object of its own, as with controllers of the catalogue.
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


def _is_numeric(answer: object) -> bool:
    if isinstance(answer, numbers.Real | np.ndarray):
        return not isinstance(answer, bool)
    return isinstance(answer, tuple | list) and all(isinstance(one, numbers.Real) for one in answer)


def _needed(function: Callable[..., object]) -> int:
    """Return how many arguments have to be given by place."""
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
