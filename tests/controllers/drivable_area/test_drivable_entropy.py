"""The entropies of the drivable area at the ends and in between."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from controllers.drivable_area.drivable_entropy import EntropyMode, entropy_cost

NOBODY = np.zeros(())
PROBABILITIES = some.floats(1e-9, 1.0)


def _cost(places: list[float], mode: EntropyMode, area: float = 1.0, collision: float = 0.0) -> float:
    return float(entropy_cost(np.array(places), np.asarray(collision), area, mode))


@pytest.mark.parametrize("mode", EntropyMode)
def test_nobody_in_the_space_costs_nothing(mode: EntropyMode) -> None:
    assert _cost([0.0, 0.0], mode) == 0.0
    assert _cost([], mode) == 0.0


def test_a_certain_meeting_costs_nothing_but_as_a_risk_as_much_as_can_be() -> None:
    assert _cost([1.0], EntropyMode.PAPER) == 0.0
    assert _cost([1.0], EntropyMode.SHANNON) == 0.0
    assert _cost([], EntropyMode.RISK, collision=1.0) == pytest.approx(-math.log(1e-6))


def test_an_unlikely_meeting_costs_most_as_printed_and_nothing_otherwise() -> None:
    assert _cost([1e-9], EntropyMode.PAPER) == pytest.approx(9.0 * math.log(10.0))
    assert _cost([1e-9], EntropyMode.SHANNON) < 1e-7
    assert _cost([], EntropyMode.RISK, collision=1e-9) < 1e-8


@given(PROBABILITIES, some.floats(0.5, 60.0))
def test_one_place(probability: float, area: float) -> None:
    logarithm = math.log(probability)
    assert _cost([probability], EntropyMode.PAPER, area) == pytest.approx(-logarithm / area)
    assert _cost([probability], EntropyMode.SHANNON, area) == pytest.approx(-probability * logarithm / area)


@given(some.integers(1, 30))
def test_even_places_have_the_entropy_of_their_number(count: int) -> None:
    assert _cost([1.0 / count] * count, EntropyMode.SHANNON) == pytest.approx(math.log(count), abs=1e-12)


@given(some.lists(some.floats(0.0, 1.0), min_size=1, max_size=6), some.floats(0.0, 1.0))
def test_no_entropy_is_negative(places: list[float], collision: float) -> None:
    for mode in EntropyMode:
        assert _cost(places, mode, 3.0, collision) >= 0.0


@given(some.floats(0.0, 1.0), some.floats(0.0, 1.0))
def test_the_risk_grows_with_the_probability_of_a_collision(one: float, other: float) -> None:
    low, high = sorted((one, other))
    assert _cost([], EntropyMode.RISK, collision=low) <= _cost([], EntropyMode.RISK, collision=high)


def test_a_presence_and_a_place_have_the_entropy_of_both() -> None:
    present, places = 0.6, np.array([0.2, 0.3, 0.5])
    joint = _cost((present * places).tolist(), EntropyMode.SHANNON)
    chain = -present * math.log(present) - present * float((places * np.log(places)).sum())
    assert joint == pytest.approx(chain)


def test_a_space_without_area_costs_nothing() -> None:
    costs = entropy_cost(np.full((2, 3), 0.2), NOBODY, np.array([0.0, 1.0]), EntropyMode.PAPER)
    assert costs[0] == 0.0
    assert costs[1] > 1.0
