"""In which direction people of the world cross."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from cosim.pedestrians.crossing_direction import ANGLES, CrossingDirection

EXAMPLE = (8.0, -5.0, 1.0)
"""The paper's: width of the road, goal along it and goal beyond it [m]."""
MODEL = CrossingDirection()


def test_the_most_probable_direction_is_within_two_degrees_of_the_papers() -> None:
    probabilities = MODEL.probabilities(*EXAMPLE)
    assert math.degrees(ANGLES[np.argmax(probabilities)]) == pytest.approx(102.0)
    # U1 = (16 − 8) / 8 and U2 = 1 − (√26 / 20)² straight across, U1 = 0 and U2 = 1 − (18.88 / 20)² at 30°.
    straight, first = 0.4 + 0.6 * (1.0 - 26.0 / 400.0), 0.6 * (1.0 - 18.8832**2 / 400.0)
    assert math.log(probabilities[60] / probabilities[0]) == pytest.approx(
        (straight - first) / 0.05, rel=1e-4
    )


@given(some.floats(2.0, 40.0), some.floats(-60.0, 60.0), some.floats(0.0, 30.0), some.floats(1e-3, 10.0))
def test_probabilities_are_a_distribution_and_a_mirrored_goal_mirrors_it(
    width: float, along: float, beyond: float, scale: float
) -> None:
    model = CrossingDirection(scale=scale)
    probabilities = model.probabilities(width, along, beyond)
    assert probabilities.sum() == pytest.approx(1.0, abs=1e-12)
    assert (probabilities >= 0.0).all()
    # The smaller the scale, the more of a difference rounding makes.
    mirrored = model.probabilities(width, -along, beyond)[::-1]
    np.testing.assert_allclose(probabilities, mirrored, atol=1e-10)


def test_draws_follow_the_probabilities_and_the_seed() -> None:
    first, second = (np.random.default_rng(5) for _ in range(2))
    drawn = np.array([MODEL.draw(*EXAMPLE, first) for _ in range(4000)])
    assert [MODEL.draw(*EXAMPLE, second) for _ in range(10)] == drawn[:10].tolist()
    expected = float(MODEL.probabilities(*EXAMPLE) @ ANGLES)
    # Three standard errors of the mean.
    assert float(drawn.mean()) == pytest.approx(expected, abs=3.0 * math.radians(14.8) / math.sqrt(4000))
