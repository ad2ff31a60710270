"""Scripted pedestrians who choose their direction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.prediction.direction_choice import DirectionModel, Errand
from cosim.toy_direction import crossing_walk, drawn_walk
from cosim.toy_world import ToyRoad

ROAD = ToyRoad(lanes=2, lane_width=4.0)


@pytest.mark.parametrize(("from_left", "begins", "ends"), [(True, 6.0, -2.0), (False, -2.0, 6.0)])
@pytest.mark.parametrize("degrees", [30.0, 90.0, 150.0])
def test_who_crosses_walks_from_kerb_to_kerb_and_stays(
    from_left: bool, begins: float, ends: float, degrees: float
) -> None:
    angle = math.radians(degrees)
    motion = crossing_walk(ROAD, 50.0, from_left=from_left, angle=angle, start=2.0)
    needed = 8.0 / math.sin(angle) / 1.25
    assert motion(1.0) == (50.0, begins, 0.0, 0.0)
    x, y, x_speed, y_speed = motion(2.0 + 0.5 * needed)
    assert y == pytest.approx(0.5 * (begins + ends))
    assert math.hypot(x_speed, y_speed) == pytest.approx(1.25)
    x, y, x_speed, y_speed = motion(100.0)
    assert y == pytest.approx(ends)
    assert (x_speed, y_speed) == (0.0, 0.0)
    assert x == pytest.approx(50.0 + 8.0 / math.tan(angle))


def test_the_seed_decides_the_direction_and_many_follow_the_model() -> None:
    errand = Errand(8.0, -5.0, 1.0)

    def angles(seed: int, count: int) -> list[float]:
        drawn = np.random.default_rng(seed)
        walks = [
            drawn_walk(ROAD, 0.0, from_left=True, generator=drawn, goal_along=-5.0, goal_beyond=1.0)
            for _ in range(count)
        ]
        return [math.atan2(-motion(0.1)[3], motion(0.1)[2]) for motion in walks]

    assert angles(3, 20) == angles(3, 20)
    assert angles(3, 20) != angles(4, 20)
    model = DirectionModel()
    mean = float(np.mean(angles(5, 1000)))
    expected = float(model.probabilities(errand) @ np.deg2rad(np.arange(30.0, 151.0)))
    assert mean == pytest.approx(expected, abs=3.0 * math.radians(15.0) / math.sqrt(1000))


@pytest.mark.parametrize(
    ("angle", "speed", "message"),
    [(0.0, 1.0, "angle = 0.0"), (4.0, 1.0, "angle = 4.0"), (1.0, 0.0, "speed = 0.0")],
)
def test_a_walk_that_leads_nowhere_is_refused(angle: float, speed: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        crossing_walk(ROAD, 0.0, from_left=True, angle=angle, speed=speed)
