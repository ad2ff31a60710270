"""Settings as models: what is made of a signature, and that every own parameter says what it is."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import pytest
from pydantic import Field, ValidationError

from controllers import catalog
from controllers.parameters import Parameter, described_by, told, unknown
from controllers.settings import (
    ControllerSettings,
    OneOf,
    PositiveOrInfinite,
    SettingsModel,
    Unit,
    call,
    model_of,
)

every_controller = pytest.mark.parametrize("name", catalog.names())


class Example(SettingsModel):
    """Of each kind one."""

    moved: ClassVar = {"old_m": "it is called new_m"}

    reach_m: Annotated[float, Field(gt=0.0, le=9.0)] | None = None
    """How far it
    reaches."""
    weight: Annotated[PositiveOrInfinite, Unit("1/m²")] = float("inf")
    count: Annotated[int, Field(ge=2)] = 3
    loud: bool = False
    colour: Annotated[str, OneOf(lambda: ("red", "blue"))] = "red"
    label: str = "none"


def _line(**values: object) -> str:
    with pytest.raises(ValidationError) as caught:
        Example(**values)  # type: ignore[arg-type]  # wrong on purpose
    return told(Example, caught.value)


def test_a_model_says_all_that_is_known_of_a_parameter() -> None:
    assert described_by(Example) == (
        Parameter("reach_m", None, "m", "more than 0 and at most 9 or none", (), "How far it reaches."),
        Parameter("weight", float("inf"), "1/m²", "more than 0", (), ""),
        Parameter("count", 3, "", "a whole number, at least 2", (), ""),
        Parameter("loud", False, "", "true or false", (), ""),
        Parameter("colour", "red", "", "'red' or 'blue'", ("red", "blue"), ""),
        Parameter("label", "none", "", "a text", (), ""),
    )


def test_texts_are_taken_as_values() -> None:
    texts = {"reach_m": " 3 ", "weight": "inf", "count": "4", "loud": "yes", "colour": "blue", "label": " a "}
    made = Example.model_validate(texts)
    assert made.model_dump() == {
        "reach_m": 3.0, "weight": float("inf"), "count": 4, "loud": True, "colour": "blue", "label": "a",
    }  # fmt: skip
    assert Example.model_validate({"reach_m": "none", "label": "none"}).model_dump(include={"reach_m", "label"}) == {
        "reach_m": None, "label": "none",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"reach_m": "far"}, "reach_m = 'far': expected a number or none"),
        ({"reach_m": 10}, "reach_m = 10: expected at most 9 or none"),
        ({"reach_m": True}, "reach_m = True: expected a number or none"),
        ({"weight": "nan"}, "weight = 'nan': expected more than 0"),
        ({"count": 2.5}, "count = 2.5: expected a whole number"),
        ({"count": True}, "count = True: expected a whole number"),
        ({"loud": "perhaps"}, "loud = 'perhaps': expected true or false"),
        ({"colour": "green"}, "colour = 'green': expected 'red' or 'blue'"),
        ({"cuont": 3}, "no parameter 'cuont'; did you mean 'count'? there are: reach_m, weight, count, loud, "
         "colour, label"),
        ({"old_m": 3}, "no parameter 'old_m': it is called new_m"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_line(values: dict[str, Any], line: str) -> None:
    assert _line(**values) == line


def _plain(*, acceleration: float = 0.0, way: int | str = 1, seed: int = 1) -> dict[str, object]:
    return dict(locals())


def test_a_signature_becomes_a_model_and_is_called_with_its_values() -> None:
    model = model_of(_plain)
    assert [one.name for one in described_by(model)] == ["acceleration", "way"]
    made = model.model_validate({"acceleration": "0.5", "way": "left", "seed": 7})
    assert call(_plain, made) == {"acceleration": 0.5, "way": "left", "seed": 7}
    assert "no parameter 'x'" in unknown(model, "x")
    with pytest.raises(ValidationError) as caught:
        model.model_validate({"way": [1]})
    assert told(model, caught.value) == "way = [1]: expected a whole number or a text"


def test_a_parameter_without_a_default_is_refused() -> None:
    def build(*, reach_m: float) -> None: ...

    with pytest.raises(TypeError, match="'reach_m' of build has no default"):
        model_of(build)


@every_controller
def test_every_parameter_says_what_it_means_within_which_bounds(name: str) -> None:
    assert issubclass(catalog.model_of(name), ControllerSettings)
    for one in catalog.described(name):
        assert one.meaning.endswith("."), one.name
        assert one.bounds not in ("", "a number"), one.name
        if isinstance(one.default, float) and one.name.rpartition("_")[2] in (
            "s",
            "m",
            "mps",
            "mps2",
            "mps3",
        ):
            assert one.unit, one.name


def test_who_types_what_is_a_controller_of_its_own_now_is_told_so() -> None:
    with pytest.raises(catalog.CatalogError, match="--controller vo_paper"):
        catalog.parse("vo_mpc", {"model": "paper"})
    assert catalog.having("euler_steps") == ("vo_ga", "vo_paper")
