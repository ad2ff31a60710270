"""Closed forms, bounds and the paper's example of the model of directions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.prediction.direction_choice import (
    ANGLES,
    GOAL_UTILITIES,
    LENGTH_UTILITIES,
    DirectionModel,
    Errand,
    velocity,
)

EXAMPLE = Errand(8.0, goal_along=-5.0, goal_beyond=1.0)
FINE = np.deg2rad(np.linspace(30.0, 150.0, 12001))
PROPERTIES = st.builds(
    Errand,
    st.floats(2.0, 40.0),
    st.floats(-60.0, 60.0),
    st.floats(0.0, 30.0),
)


def _best(length: str, goal: str, weight: float) -> float:
    model = DirectionModel(weight, length_utility=length, goal_utility=goal)
    return math.degrees(float(FINE[np.argmax(model.utilities(EXAMPLE, FINE))]))


def test_there_are_121_alternatives_a_degree_apart() -> None:
    assert len(ANGLES) == 121
    np.testing.assert_allclose(np.diff(np.rad2deg(ANGLES)), 1.0)
    np.testing.assert_allclose(np.rad2deg(ANGLES[[0, -1]]), [30.0, 150.0])


def test_the_longest_way_over_the_road_is_at_both_ends_and_the_shortest_straight_across() -> None:
    lengths = EXAMPLE.lengths()
    np.testing.assert_allclose(lengths[[0, -1]], 16.0)
    assert EXAMPLE.longest == 16.0
    assert np.argmin(lengths) == 60
    assert lengths[60] == pytest.approx(8.0)


def test_the_goal_is_18_88_m_away_at_most() -> None:
    assert EXAMPLE.remaining()[0] == pytest.approx(18.883, abs=5e-4)
    assert EXAMPLE.furthest == 20.0
    assert math.degrees(EXAMPLE.bearing) == pytest.approx(119.05, abs=0.01)


def test_who_walks_towards_their_goal_reaches_the_other_kerb_on_the_way_to_it() -> None:
    """With the goal on the opposite kerb, the bearing leads exactly there."""
    errand = Errand(8.0, -3.0, 0.0)
    assert errand.remaining(np.array([errand.bearing]))[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("length", "goal", "paper_weight", "other_weight"),
    [
        ("linear", "linear", 119.6, 114.9),
        ("scaled", "linear", 116.1, 104.6),
        ("scaled", "squared", 101.6, 96.3),
        ("linear", "squared", 107.4, 100.7),
        ("squared", "squared", 107.0, 100.6),
        ("linear", "gaussian", 107.2, 100.5),
        ("circular", "circular", 105.8, 99.7),
        ("linear", "circular", 101.7, 96.4),
        ("scaled", "cosine", 107.0, 101.0),
        ("linear", "angular", 119.0, 119.0),
    ],
)
def test_the_readings_of_the_utilities_do_not_agree_on_the_most_probable_direction(
    length: str, goal: str, paper_weight: float, other_weight: float
) -> None:
    tolerance = 0.3 if goal in ("cosine", "angular") else 0.051
    assert _best(length, goal, 0.4) == pytest.approx(paper_weight, abs=tolerance)
    assert _best(length, goal, 0.6) == pytest.approx(other_weight, abs=tolerance)


@pytest.mark.parametrize(
    ("length", "goal", "weight"),
    [
        ("linear", "linear", 0.816),
        ("scaled", "linear", 0.689),
        ("scaled", "squared", 0.453),
        ("linear", "squared", 0.623),
        ("squared", "squared", 0.620),
        ("linear", "gaussian", 0.615),
        ("circular", "circular", 0.588),
        ("linear", "circular", 0.457),
    ],
)
def test_every_reading_gives_the_papers_direction_with_some_weight(
    length: str, goal: str, weight: float
) -> None:
    assert _best(length, goal, weight) == pytest.approx(100.0, abs=0.1)


def test_the_default_is_within_two_degrees_of_the_paper() -> None:
    assert math.degrees(DirectionModel().most_probable(EXAMPLE)) == pytest.approx(102.0)


def test_the_scale_moves_the_spread_and_not_the_most_probable_direction() -> None:
    narrow, wide = DirectionModel(scale=0.02), DirectionModel(scale=0.2)
    assert narrow.most_probable(EXAMPLE) == wide.most_probable(EXAMPLE)
    assert narrow.spread(EXAMPLE) < DirectionModel().spread(EXAMPLE) < wide.spread(EXAMPLE)


def test_the_default_scale_spreads_by_fifteen_degrees() -> None:
    degrees, probabilities = np.rad2deg(ANGLES), DirectionModel().probabilities(EXAMPLE)
    mean = float(probabilities @ degrees)
    deviation = math.sqrt(float(probabilities @ (degrees - mean) ** 2))
    assert deviation == pytest.approx(14.8, abs=0.1)
    assert probabilities.max() == pytest.approx(0.026, abs=5e-4)


def test_a_goal_straight_across_is_walked_to_straight_across() -> None:
    for length in LENGTH_UTILITIES:
        for goal in GOAL_UTILITIES:
            model = DirectionModel(length_utility=length, goal_utility=goal)
            assert math.degrees(model.most_probable(Errand(8.0, 0.0, 1.0))) == pytest.approx(90.0)


@given(
    PROPERTIES,
    st.floats(0.0, 1.0),
    st.floats(1e-3, 10.0),
    st.sampled_from(sorted(LENGTH_UTILITIES)),
    st.sampled_from(sorted(GOAL_UTILITIES)),
)
def test_probabilities_are_a_distribution_and_the_most_probable_is_an_alternative(
    errand: Errand, weight: float, scale: float, length: str, goal: str
) -> None:
    model = DirectionModel(weight, scale, length, goal)
    probabilities = model.probabilities(errand)
    assert probabilities.sum() == pytest.approx(1.0, abs=1e-12)
    assert (probabilities >= 0.0).all()
    best = model.most_probable(errand)
    assert best in ANGLES
    assert probabilities[np.flatnonzero(best == ANGLES)[0]] == pytest.approx(probabilities.max())
    assert 0.0 <= model.spread(errand) <= 2.0


@given(PROPERTIES)
def test_a_mirrored_goal_mirrors_the_choice(errand: Errand) -> None:
    mirrored = Errand(errand.road_width, -errand.goal_along, errand.goal_beyond)
    model = DirectionModel()
    np.testing.assert_allclose(model.probabilities(errand), model.probabilities(mirrored)[::-1], atol=1e-12)


@given(st.floats(0.1, 3.0), st.floats(0.5, 2.6), st.booleans())
def test_the_velocity_has_the_speed_and_leads_onto_the_road(
    speed: float, angle: float, from_left: bool
) -> None:
    along, across = velocity(angle, speed, from_left=from_left)
    assert math.hypot(along, across) == pytest.approx(speed)
    assert (across < 0.0) == from_left


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"length_weight": 1.1}, "length_weight = 1.1 must be between 0 and 1"),
        ({"scale": 0.0}, "scale = 0.0 must be greater than 0"),
        ({"length_utility": "cubic"}, "length_utility = 'cubic' is none of linear, scaled"),
        ({"goal_utility": "scaled"}, "goal_utility = 'scaled' is none of linear, squared"),
    ],
)
def test_a_model_out_of_range_is_refused(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DirectionModel(**arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("width", [0.0, -1.0, math.inf, math.nan])
def test_a_road_without_width_is_refused(width: float) -> None:
    with pytest.raises(ValueError, match="road_width"):
        Errand(width)
