"""Lists the scenarios, controllers, metrics and sensing models, with short descriptions and parameters."""

from __future__ import annotations

import numbers
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from analysis.results import metric_catalog
from controllers import catalog
from controllers.interface import Controller
from controllers.parameters import Parameter
from cosim.errors import InputError
from cosim.sensing import catalog as sensing_catalog
from cosim.step.drivers import release
from sumo_scenarios import library


@dataclass(frozen=True, slots=True)
class Entry:
    """A scenario, controller, metric or sensing model."""

    name: str
    description: str
    parameters: tuple[str, ...] = ()
    """``name=default`` in the form that ``--set`` takes, followed by the unit and the choices."""


def scenarios() -> list[Entry]:
    """Return the built-in scenarios."""
    found = [library.load(name) for name in library.names()]
    return [
        Entry(
            each.name,
            each.description,
            tuple(
                _setting(key, value) + _choices(library.parameter_choices(each, key))
                for key, value in library.parameter_values(each).items()
            ),
        )
        for each in found
    ]


def controller_parameters(name: str) -> tuple[str, ...]:
    """Return the names of a controller's parameters."""
    return tuple(catalog.parameters(name))


def moved_parameters(names: Iterable[str]) -> dict[str, str]:
    """Return the parameters that these controllers no longer have and, for each, what to use instead."""
    return {key: told for name in names for key, told in catalog.moved(name).items()}


def described_controller(name: str) -> tuple[Parameter, ...]:
    """Return the descriptions of a controller's parameters.

    Raises
    ------
    InputError
        If there is no such controller.
    """
    try:
        return catalog.described(name)
    except catalog.CatalogError as error:
        raise InputError(str(error)) from error


def controller_maker(name: str, settings: Mapping[str, str]) -> Callable[[], Controller]:
    """Return a function that makes a new controller with these parameters, given as ``--set`` takes them.

    Raises
    ------
    InputError
        If there is no such controller or parameter, or the controller cannot be made.
    """
    try:
        values: dict[str, Any] = catalog.parse(name, settings)
        release(catalog.build(name, **values))
    except catalog.CatalogError as error:
        raise InputError(str(error)) from error
    return partial(catalog.build, name, **values)


def described_sensing(name: str) -> tuple[Parameter, ...]:
    """Return the descriptions of a sensing model's parameters.

    Raises
    ------
    InputError
        If there is no such model.
    """
    return sensing_catalog.described(name)


def controllers() -> list[Entry]:
    """Return the controllers of this project and of installed plug-ins; a broken one does not hide others."""
    return [_controller(name) for name in catalog.names()]


def _controller(name: str) -> Entry:
    try:
        return Entry(name, catalog.describe(name), tuple(map(_with_unit, catalog.described(name))))
    except catalog.CatalogError as error:
        return Entry(name, f"not usable: {error}")


def sensing_models() -> list[Entry]:
    """Return the sensing models."""
    return [
        Entry(name, sensing_catalog.describe(name), tuple(map(_with_unit, sensing_catalog.described(name))))
        for name in sensing_catalog.names()
    ]


def as_text(value: object) -> str:
    """Return a value in the form that ``--set`` takes."""
    if value is None or isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, numbers.Real):  # the repr of NumPy's numbers includes their type
        return str(int(value)) if isinstance(value, numbers.Integral) else repr(float(value))
    return str(value)


def _setting(key: str, value: object) -> str:
    return f"{key}={as_text(value)}"


def _with_unit(parameter: Parameter) -> str:
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return _setting(parameter.name, parameter.default) + unit + _choices(parameter.choices)


def _choices(texts: tuple[str, ...]) -> str:
    return f" ({'|'.join(texts)})" if texts else ""


def metrics() -> list[Entry]:
    """Return the metrics of encounters and of runs, with unit and direction."""
    return [
        Entry(
            metric.name,
            f"{metric.text.partition(chr(10))[0]} [{metric.unit}; {_direction(metric.worse)}; "
            f"per {metric.scope}]",
        )
        for metric in metric_catalog.find_metrics()
    ]


def _direction(worse: str) -> str:
    return f"{worse} is worse" if worse in ("higher", "lower") else "neither direction is worse"


def scenario_settings(name: str) -> dict[str, Any]:
    """Return the values of a scenario's parameters, by the names that ``--set`` takes.

    Raises
    ------
    InputError
        If there is no such scenario.
    """
    try:
        return dict(library.parameter_values(library.load(name)))
    except library.ScenarioError as error:
        raise InputError(str(error)) from error
