"""The manual's levels of service, at their bounds."""

from __future__ import annotations

import pytest

from analysis.encounters.hcm import level_of_service


@pytest.mark.parametrize(
    ("delay", "level"),
    [(0.0, "A"), (4.99, "A"), (5.0, "B"), (13.88, "C"), (20.0, "D"), (44.9, "E"), (45.0, "F"), (900.0, "F")],
)
def test_a_delay_has_the_level_in_whose_range_it_is(delay: float, level: str) -> None:
    assert level_of_service(delay) == level
