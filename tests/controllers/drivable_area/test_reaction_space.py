"""The reaction space against integrals and circles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from scipy.integrate import quad
from shapely.geometry import Polygon

from controllers.drivable_area.reaction_space import ReactionSpace
from controllers.safety.emergency_braking import GRAVITY

SPEEDS = some.floats(1.0, 40.0)


@pytest.mark.parametrize(("kmh", "radius", "area"), [(40, 15.7, 24.9), (50, 24.6, 48.4)])
def test_radius_and_area_at_the_speeds_of_the_paper(kmh: float, radius: float, area: float) -> None:
    space = ReactionSpace(kmh / 3.6)
    assert space.radius == pytest.approx(radius, abs=0.05)
    assert space.area == pytest.approx(area, abs=0.05)


@given(SPEEDS, some.floats(0.2, 1.0))
def test_the_arc_is_driven_at_the_speed_with_all_of_the_grip(speed: float, friction: float) -> None:
    space = ReactionSpace(speed, friction=friction)
    times = np.linspace(0.0, 0.3, 4)
    h = 1e-4
    before, now, after = (space.limit(times + shift) for shift in (-h, 0.0, h))
    x_speed, y_speed = ((b - a) / (2 * h) for a, b in zip(before, after, strict=True))
    x_change, y_change = ((a - 2 * n + b) / h**2 for a, n, b in zip(before, now, after, strict=True))
    np.testing.assert_allclose(np.hypot(x_speed, y_speed), speed, rtol=1e-6)
    np.testing.assert_allclose(np.hypot(x_change, y_change), friction * GRAVITY, rtol=1e-3)
    assert now[0][0] == 0.0
    assert now[1][0] == pytest.approx(0.9)


@given(SPEEDS)
def test_the_side_and_the_arc_say_the_same(speed: float) -> None:
    space = ReactionSpace(speed)
    forward, left = space.limit(np.linspace(0.0, 0.5 * math.pi * speed / (0.8 * GRAVITY), 9))
    np.testing.assert_allclose(space.half_width(forward), left, rtol=1e-6)


@given(SPEEDS, some.floats(0.0, 2.0))
def test_the_area_is_the_integral_between_the_arcs(speed: float, resistance: float) -> None:
    space = ReactionSpace(speed, resistance=resistance)
    integral, _ = quad(lambda x: 2.0 * float(space.half_width(np.asarray(x))), 0.0, space.reach)
    assert space.area == pytest.approx(integral, rel=1e-6)
    outline = Polygon(space.outline(400))
    assert outline.area == pytest.approx(space.area, rel=1e-3)


def test_the_reach_is_the_stopping_distance_and_then_stays() -> None:
    space = ReactionSpace(10.0, friction=0.5, resistance=0.1)
    braking = 0.5 * GRAVITY + 0.1
    assert space.reach == pytest.approx(100.0 / (2.0 * braking))
    assert space.reach_at(1.0) == pytest.approx(10.0 - 0.5 * braking)
    assert space.reach_at(60.0) == space.reach


def test_a_standing_car_reaches_nothing() -> None:
    space = ReactionSpace(0.0)
    assert space.area == 0.0
    assert space.reach == 0.0
    assert space.limit(np.array([0.0, 1.0]))[1].tolist() == [0.9, 0.9]
    assert not space.contains(np.array([0.1]), np.zeros(1)).any()


def test_points_in_the_space() -> None:
    space = ReactionSpace(40 / 3.6)
    forward = np.array([-0.1, 0.1, 0.1, 7.8, 7.8, 7.9])
    left = np.array([0.0, 0.89, 0.95, 2.9, -3.1, 0.0])
    assert space.contains(forward, left).tolist() == [False, True, False, True, False, False]
