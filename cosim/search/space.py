"""The space of a search: the ``[search]`` table of a scenario.toml, or a file with the same content."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from analysis.errors import did_you_mean
from analysis.search.axes import Axis, Value, rounded
from analysis.search.results import TAKEN
from cosim.errors import InputError
from cosim.toml_files import read_toml
from sumo_scenarios.distribution import Distribution, read_distribution
from sumo_scenarios.errors import most_telling

LONGEST_PASSAGE_S = 30.0
"""Longest simulated time of a trial after its warm-up [s]."""
TAILS = 1e-9
PASSAGE = "passage"
"""Name of the axis that says where a trial takes place."""
OF_PASSAGES = ("crossing", "route")
"""Further properties of a passage that a table may name."""
_NAME = re.compile(r"[a-z][a-z0-9_]*")


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class ParameterTable(_Table):
    """A parameter that is varied: a number from ``minimum`` to ``maximum``, or one of ``choices``."""

    minimum: float | None = None
    maximum: float | None = None
    whole: bool = False
    choices: list[str] = []
    weights: list[Annotated[float, Field(ge=0, allow_inf_nan=False)]] = []
    distribution: dict[str, Any] | None = None
    """Distribution of the number in reality, for ``cosim estimate``; uniform if not given."""
    when: dict[str, list[str]] = {}
    """Choices of other parameters for which this one has an effect."""
    description: str = ""
    source: str = ""

    @model_validator(mode="after")
    def ranged(self) -> ParameterTable:
        """Check that the parameter has exactly one range."""
        bounds = (self.minimum, self.maximum)
        if self.choices:
            if bounds != (None, None) or self.distribution is not None or self.whole:
                raise ValueError("expected either 'choices' or a range from 'minimum' to 'maximum'")
            if len(set(self.choices)) < len(self.choices):
                raise ValueError("'choices': one is named twice")
            if self.weights and (len(self.weights) != len(self.choices) or sum(self.weights) <= 0.0):
                raise ValueError(f"'weights': expected {len(self.choices)} numbers, not all of them 0")
            return self
        if self.minimum is None or self.maximum is None:
            raise ValueError("has no range; expected 'minimum' and 'maximum', or 'choices'")
        if not (math.isfinite(self.minimum) and math.isfinite(self.maximum)) or self.minimum >= self.maximum:
            raise ValueError(f"expected minimum < maximum, got {self.minimum:g} and {self.maximum:g}")
        if self.weights:
            raise ValueError("'weights' belongs to 'choices'")
        if self.whole and not (self.minimum.is_integer() and self.maximum.is_integer()):
            raise ValueError("'whole': expected whole numbers as minimum and maximum")
        return self


class WhereTable(_Table):
    """Crossings of the network at which a trial may take place."""

    crossings: list[str] = []
    """Ids of crossings; empty for all that a car can drive over."""
    longest_approach_m: Annotated[float, Field(gt=0)] = 300.0
    shortest_approach_m: Annotated[float, Field(gt=0)] = 80.0


class SearchTable(_Table):
    """Content of ``[search]``."""

    duration_s: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 40.0
    warmup_s: Annotated[float, Field(ge=0, allow_inf_nan=False)] | str = 10.0
    seed: Literal["fixed", "averaged", "searched"] = "fixed"
    seeds: Annotated[int, Field(ge=1, le=1000)] = 3
    """Number of seeds, if they are averaged or searched."""
    where: WhereTable | None = None
    values: dict[str, bool | int | float | str] = {}
    egos: dict[str, Any] = {}
    sensing: dict[str, Any] = {}
    pedestrians: list[dict[str, Any]] = []
    criteria: list[dict[str, Any]] = []
    parameters: dict[str, ParameterTable] = {}


@dataclass(frozen=True, slots=True)
class Parameter:
    """An axis, and the distribution of its values."""

    axis: Axis
    distribution: Distribution
    description: str = ""
    source: str = ""

    def quantile(self, share: float) -> Value:
        """Return the value below which this share of the distribution lies."""
        share = min(max(share, TAILS), 1.0 - TAILS)
        if self.axis.choices:
            return self.axis.choices[int(self.distribution.quantile(share))]
        value = self.distribution.quantile(share)
        if self.axis.whole:
            return round(value)
        return min(max(rounded(value), self.axis.low), self.axis.high)


@dataclass(frozen=True, slots=True)
class Space:
    """All that a search needs to know about a scenario."""

    table: SearchTable
    parameters: tuple[Parameter, ...]
    place: str
    """Where the space is declared, for messages."""
    folder: Path | None = None
    """Folder of the file that declares it; trajectories are relative to it. ``None`` without a file."""

    @property
    def named(self) -> frozenset[str]:
        """Parameters that the table uses as ``"$name"``; the others are those of the scenario."""
        table = self.table
        parts = (table.egos, table.sensing, table.pedestrians, table.values, table.warmup_s)
        return frozenset(name for part in parts for name in names_in(part))

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Axes in the order of their declaration."""
        return tuple(one.axis for one in self.parameters)


def read_space(content: Mapping[str, Any], place: str, folder: Path | None = None) -> Space:
    """Return the space that a table declares; ``folder`` is that of its file, if there is one.

    Raises
    ------
    InputError
        If the table is invalid; one line with the place, the key, and what was expected.
    """
    try:
        table = SearchTable.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{place}: {_first_line(error)}") from error
    _check_free(table, place)
    parameters = tuple(_parameter(name, one, place) for name, one in table.parameters.items())
    _check_conditions(table, place)
    if not parameters and table.where is None:
        raise InputError(f"{place}: nothing to vary; expected at least one of [search.parameters.NAME]")
    return Space(table, parameters, place, folder)


def read_space_file(path: Path) -> Space:
    """Return the space in a file, which holds the content of ``[search]`` with or without that heading.

    Raises
    ------
    InputError
        As for `read_space`, and if the file cannot be read.
    """
    content = read_toml(path, "--space")
    inner = content.get("search", content)
    if "search" in content and len(content) > 1:
        raise InputError(f"--space {path}: only [search] expected, got {', '.join(sorted(content))}")
    return read_space(inner, str(path), path.resolve().parent)


def names_in(value: Any) -> Iterator[str]:
    """Return the parameters that a table names as ``"$name"``."""
    if isinstance(value, str) and value.startswith("$"):
        yield value[1:]
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from names_in(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from names_in(inner)


def filled(value: Any, values: Mapping[str, Any], place: str) -> Any:
    """Return a table with ``"$name"`` replaced by values.

    Raises
    ------
    InputError
        If a name is not that of a parameter.
    """
    if isinstance(value, str) and value.startswith("$"):
        if value[1:] not in values:
            hint = did_you_mean(value[1:], sorted(values))
            raise InputError(f"{place}: names {value}; {hint}parameters that exist: {', '.join(values)}")
        return values[value[1:]]
    if isinstance(value, Mapping):
        return {key: filled(inner, values, place) for key, inner in value.items()}
    if isinstance(value, list):
        return [filled(inner, values, place) for inner in value]
    return value


def _check_free(table: SearchTable, place: str) -> None:
    taken = TAKEN if table.where is None else TAKEN | {PASSAGE, *OF_PASSAGES}
    for name in table.parameters:
        if name in taken:
            raise InputError(
                f"{place}: parameters.{name}: the name is taken; expected none of {', '.join(sorted(taken))}"
            )


def _check_conditions(table: SearchTable, place: str) -> None:
    for name, one in table.parameters.items():
        for other, choices in one.when.items():
            known = table.parameters[other].choices if other in table.parameters else []
            unknown = sorted(set(choices) - set(known))
            if unknown or not choices:
                exist = ", ".join(known) or f"no parameter {other} with choices"
                raise InputError(
                    f"{place}: parameters.{name}: when.{other}: expected some of its choices, got "
                    f"{choices!r}; there are: {exist}"
                )


def _parameter(name: str, table: ParameterTable, place: str) -> Parameter:
    where = f"{place}: parameters.{name}"
    if not _NAME.fullmatch(name):
        raise InputError(f"{where}: expected small letters, digits and '_' in a name, a letter first")
    when = tuple((other, tuple(choices)) for other, choices in table.when.items())
    if table.choices:
        axis = Axis(name, choices=tuple(table.choices), when=when)
        numbers = tuple(float(number) for number in range(len(table.choices)))
        return Parameter(
            axis, Distribution("choice", numbers, tuple(table.weights)), table.description, table.source
        )
    assert table.minimum is not None
    assert table.maximum is not None
    axis = Axis(name, table.minimum, table.maximum, table.whole, when=when)
    if table.distribution is None:
        # Every whole number gets an interval of the same length around it.
        wider = 0.499999 if table.whole else 0.0
        distribution = Distribution("uniform", (table.minimum - wider, table.maximum + wider))
        return Parameter(axis, distribution, table.description, table.source)
    said = dict(table.distribution)
    if "normal" in said or "lognormal" in said:
        said = {"minimum": table.minimum, "maximum": table.maximum, **said}
    try:
        distribution = read_distribution(said, table.minimum, table.maximum)
    except ValueError as error:
        raise InputError(f"{where}: distribution: {error}") from error
    return Parameter(axis, distribution, table.description, table.source)


def _first_line(error: ValidationError) -> str:
    details = most_telling(error)
    key = ".".join(str(part) for part in details["loc"])
    message = str(details["msg"]).removeprefix("Value error, ")
    if details["type"] == "extra_forbidden":
        tables: dict[str, type[BaseModel]] = {"parameters": ParameterTable, "where": WhereTable}
        first = str(details["loc"][0])
        table = tables.get(first, SearchTable) if len(details["loc"]) > 1 else SearchTable
        hint = did_you_mean(str(details["loc"][-1]), table.model_fields)
        return f"unknown key '{key}'; {hint}keys that exist here: {', '.join(table.model_fields)}"
    if details["type"] == "value_error":
        return f"{key}: {message}"
    return f"key '{key}': {message[:1].lower()}{message[1:]}, got {details['input']!r}"
