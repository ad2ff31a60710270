"""What several pages, tables and messages write in the same way."""

from __future__ import annotations

import pytest

from analysis.wording import decimals, p_value, some


@pytest.mark.parametrize(
    ("names", "text"),
    [([], ""), (["a"], "a"), (["a", "b"], "a, b"), (["a", "b", "c", "d"], "a, b and 2 more")],
)
def test_a_list_says_how_many_it_leaves_out(names: list[str], text: str) -> None:
    assert some(names, 2) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (0.0, "< 0.001"),
        (0.00099, "< 0.001"),
        (0.001, "0.001"),
        (0.0456, "0.046"),
        (1.0, "1.000"),
    ],
)
def test_a_p_value_has_three_digits_and_is_never_nought(value: float | None, text: str) -> None:
    assert p_value(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0.0"), (0.25, "0.2"), (-0.06, "-0.06"), (0.0008, "0.0008"), (-0.1, "-0.1"), (1e-17, "0.0000")],
)
def test_a_small_number_is_not_rounded_to_0(value: float, text: str) -> None:
    assert f"{value:.{decimals(value, 1)}f}" == text


def test_a_test_that_was_not_made_is_shown_as_a_table_asks() -> None:
    assert p_value(None, "") == ""
