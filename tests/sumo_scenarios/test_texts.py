"""Texts of ``--set`` as values of the declared types, and what is said of others."""

from __future__ import annotations

from typing import Any

import pytest

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.schema import Actuation, AtLeastOne, ParameterTable, Positive, Share, Step
from sumo_scenarios.texts import Text, kind_of, read


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (Step, "0.05", 0.05),
        (Positive, " 1e3 ", 1000.0),
        (AtLeastOne, "3", 3),
        (Actuation, "move", "move"),
        (Text, "best", "best"),
    ],
)
def test_a_text_is_read_as_its_type(kind: Any, text: str, value: object) -> None:
    found = read(kind, "key", text)
    assert (type(found), found) == (type(value), value)


@pytest.mark.parametrize(
    ("kind", "text", "wanted"),
    [
        (Step, "0.04", "at least 0.05 and at most 1"),
        (Step, "fast", "a number"),
        (Positive, "0", "more than 0"),
        (Positive, "nan", "more than 0"),
        (Share, "1.5", "more than 0 and at most 1"),
        (AtLeastOne, "0", "at least 1"),
        (AtLeastOne, "1.5", "a whole number"),
        (Actuation, "fly", "one of hybrid, move"),
        (Text, " ", "a value"),
    ],
)
def test_another_text_is_answered_by_what_was_expected(kind: Any, text: str, wanted: str) -> None:
    with pytest.raises(ScenarioError) as error:
        read(kind, "key", text)
    assert str(error.value) == f"key={text}: expected {wanted}"


@pytest.mark.parametrize(
    ("declared", "text", "value"),
    [
        ({"default": 2, "minimum": 0, "maximum": 9}, "9", 9),
        ({"default": 2.5}, "-4", -4.0),
        ({"default": True}, "false", "false"),
        ({"default": "a", "choices": ["a", "b"]}, "b", "b"),
    ],
)
def test_a_declared_parameter_has_the_type_of_its_default(
    declared: dict[str, Any], text: str, value: object
) -> None:
    found = read(kind_of(ParameterTable(description="", **declared)), "key", text)
    assert (type(found), found) == (type(value), value)


def test_a_declared_bound_holds() -> None:
    with pytest.raises(ScenarioError, match="key=10: expected at least 0 and at most 9"):
        read(kind_of(ParameterTable(default=2, description="", minimum=0, maximum=9)), "key", "10")
