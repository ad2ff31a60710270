"""Converts texts of ``--set`` to values, by the types and bounds that a ``scenario.toml`` declares."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import Field, TypeAdapter, ValidationError

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.schema import ParameterTable

Text = Annotated[str, Field(min_length=1)]
_KINDS = {
    "float_parsing": "a number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_too_short": "a value",
}


def read(kind: Any, key: str, text: str) -> Any:
    """Return the value of a parameter that a text gives.

    Parameters
    ----------
    kind
        Type of the parameter, annotated with its bounds.
    key, text
        Key and text of the parameter.

    Raises
    ------
    ScenarioError
        If the text does not fit; the message is one line with what was expected.

    Examples
    --------
    >>> read(Annotated[float, Field(gt=0.0)], "headway_s", "2.5")
    2.5
    """
    try:
        return TypeAdapter(kind).validate_strings(text.strip())
    except ValidationError as error:
        (details, *_) = error.errors(include_url=False)
        raise ScenarioError(
            f"{key}={text}: expected {_KINDS.get(details['type']) or expected(kind)}"
        ) from None


def expected(kind: Any) -> str:
    """Return the allowed values of a parameter of this type, in words.

    Examples
    --------
    >>> expected(Annotated[float, Field(ge=0.05, le=1.0)])
    'at least 0.05 and at most 1'
    """
    if get_origin(kind) is Literal:
        return f"one of {', '.join(get_args(kind))}"
    if kind is bool:
        return "one of true, false"
    said = []
    for one in _bounds(kind):
        for bound, words in (("gt", "more than"), ("ge", "at least"), ("le", "at most")):
            limit = getattr(one, bound, None)
            if limit is not None and math.isfinite(limit):
                said.append(f"{words} {limit:g}")
    return " and ".join(said) or "a finite number"


def kind_of(parameter: ParameterTable) -> Any:
    """Return the type of a declared parameter: that of its default, with its bounds or choices."""
    if parameter.choices:
        return Literal[tuple(parameter.choices)]
    if isinstance(parameter.default, bool):
        return Literal["true", "false"]
    if isinstance(parameter.default, str):
        return Text
    if isinstance(parameter.default, int):
        return Annotated[int, Field(ge=parameter.minimum, le=parameter.maximum)]
    return Annotated[float, Field(ge=parameter.minimum, le=parameter.maximum, allow_inf_nan=False)]


def _bounds(kind: Any) -> list[Any]:
    return [limit for one in get_args(kind)[1:] for limit in one.metadata]
