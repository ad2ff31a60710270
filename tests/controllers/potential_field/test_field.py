"""Safe distances, potentials and their gradients, and paths down them."""

from __future__ import annotations

import math
from dataclasses import astuple, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.arrays import FloatArray
from controllers.potential_field.field import (
    Field,
    Gains,
    Obstacles,
    curvature,
    descend,
    distance_to_shift,
    meeting_time,
    needed_shift,
    side_distance,
    standing,
)

GRAVITY = 9.80665
SAFE = side_distance(0.3, 1.86, 0.6)


def _random_field(drawn: np.random.Generator, obstacles: int) -> Field:
    def several(low: float, high: float) -> FloatArray:
        return drawn.uniform(low, high, obstacles)

    return Field(
        right_edge=-4.0,
        left_edge=4.0,
        centre=float(drawn.uniform(-3.0, 3.0)),
        lines=np.array([-1.5, 1.2]),
        obstacles=Obstacles(
            several(0.0, 60.0),
            several(-4.0, 4.0),
            several(2.0, 25.0),
            several(0.5, 3.0),
            several(-2.0, 2.0),
            several(-2.0, 2.0),
            several(0.0, 1.0),
        ),
        gains=Gains(*drawn.uniform([0.5, 0.02, 0.1, 0.01, 0.01, 0.3], [2.0, 0.2, 1.0, 0.1, 0.1, 1.0])),
    )


@pytest.mark.parametrize("seed", range(20))
def test_the_gradient_is_that_of_the_potential(seed: int) -> None:
    drawn = np.random.default_rng(seed)
    shape = _random_field(drawn, seed % 5)
    x, y, time = drawn.uniform(0.0, 60.0, 50), drawn.uniform(-3.4, 3.4, 50), float(drawn.uniform(0.0, 3.0))
    by_x, by_y = shape.gradient(x, y, time)
    step = 1e-5
    along = (shape.potential(x + step, y, time) - shape.potential(x - step, y, time)) / (2.0 * step)
    across = (shape.potential(x, y + step, time) - shape.potential(x, y - step, time)) / (2.0 * step)
    np.testing.assert_allclose(by_x, along, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(by_y, across, rtol=1e-6, atol=1e-8)


def test_fields_side_by_side_are_the_fields_alone() -> None:
    shapes = [_random_field(np.random.default_rng(seed), 3) for seed in (1, 2)]
    rows = [astuple(shape.obstacles) for shape in shapes]
    together = replace(
        shapes[0],
        centre=np.array([float(shape.centre) for shape in shapes]),
        obstacles=Obstacles(*(np.vstack(columns) for columns in zip(*rows, strict=True))),
    )
    x, y = np.array([10.0, 20.0]), np.array([0.5, -0.5])
    found = together.gradient(x, y, 0.7)
    for index, shape in enumerate(shapes):
        alone = replace(shape, gains=shapes[0].gains)
        one = slice(index, index + 1)
        for value, expected in zip(found, alone.gradient(x[one], y[one], 0.7), strict=True):
            assert value[index] == pytest.approx(expected[0], rel=1e-12)
        row = together.row(index).gradient(x[one], y[one], 0.7)
        np.testing.assert_allclose(row, [value[one] for value in found])


def test_the_papers_half_axes() -> None:
    assert pytest.approx(1.83) == SAFE
    shift = needed_shift(np.array([3.0]), 2.0, SAFE)
    assert shift[0] == pytest.approx(0.83)
    assert distance_to_shift(25.0, shift, 0.3 * GRAVITY)[0] == pytest.approx(18.779, abs=5e-4)
    longest = distance_to_shift(25.0, np.array([SAFE]), 0.3 * GRAVITY)
    assert longest[0] == pytest.approx(27.88, abs=0.005)


@pytest.mark.parametrize(("apart", "longer"), [(1.29, True), (1.31, False)])
def test_the_variable_axis_is_below_15_m_beyond_1_30_m_off_the_centre_line(
    apart: float, longer: bool
) -> None:
    shift = needed_shift(np.array([2.0 - apart]), 2.0, SAFE)
    assert (distance_to_shift(25.0, shift, 0.3 * GRAVITY)[0] > 15.0) == longer


@given(st.floats(0.0, 60.0), st.floats(0.0, 5.0), st.floats(0.1, 10.0))
def test_both_forms_of_the_distance_are_the_same(speed: float, shift: float, acceleration: float) -> None:
    one = distance_to_shift(speed, np.array([shift]), acceleration)[0]
    other = 2.0 * speed * math.sqrt(shift / (2.0 * acceleration))
    assert one == pytest.approx(other, rel=1e-12, abs=1e-12)


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(0.1, 4.0))
def test_the_needed_shift_is_the_smaller_of_both_sides(obstacle: float, car: float, safe: float) -> None:
    right, left = safe - (obstacle - car), safe + (obstacle - car)
    shift = needed_shift(np.array([obstacle]), car, safe)[0]
    assert 0.0 <= shift <= safe
    assert shift == pytest.approx(max(min(right, left), 0.0), abs=1e-12)


def test_the_car_is_level_with_a_walker_when_their_places_agree() -> None:
    along, speed = np.array([50.0, 50.0, -5.0, 50.0]), np.array([1.08, -1.08, 0.0, 30.0])
    times = meeting_time(along, speed, 0.0, 25.0)
    assert np.isinf(times[3])
    assert times[2] == pytest.approx(-0.2)
    np.testing.assert_allclose(along[:3] + speed[:3] * times[:3], 25.0 * times[:3])


def test_the_pull_onwards_falls_from_the_start_and_the_others_are_least_where_they_lead() -> None:
    x, y = np.linspace(0.0, 100.0, 11), np.linspace(-3.9, 3.9, 781)
    bare = Field(-4.0, 4.0, 2.0, np.zeros(1))
    onwards = replace(bare, gains=Gains(1.0, 0.0, 0.0, 0.0, 0.0))
    assert (np.diff(onwards.potential(x, np.zeros(11))) < 0.0).all()
    centre = replace(bare, gains=Gains(0.0, 0.05, 0.0, 0.0, 0.0))
    assert y[np.argmin(centre.potential(0.0 * y, y))] == pytest.approx(2.0)
    edge = replace(bare, gains=Gains(0.0, 0.0, 0.0, 0.02, 0.0)).potential(0.0 * y, y)
    assert y[np.argmin(edge)] == pytest.approx(0.0, abs=1e-9)
    assert edge[0] > 100.0 * edge[390]
    line = replace(bare, gains=Gains(0.0, 0.0, 0.0, 0.0, 0.02)).potential(0.0 * y, y)
    assert y[np.argmax(line)] == pytest.approx(0.0, abs=1e-9)


def test_a_road_without_obstacles_is_driven_straight() -> None:
    shape = Field(-4.0, 4.0, 0.0, np.zeros(0))
    x, y = descend(shape, np.zeros(1), np.zeros(1), 25.0, 0.25, 100)
    np.testing.assert_allclose(x[:, 0], 0.25 * np.arange(101))
    np.testing.assert_allclose(y, 0.0, atol=1e-12)


def test_the_path_has_equal_steps_and_converges_with_the_second_order() -> None:
    obstacle = standing(*(np.array([value]) for value in (50.0, 3.0, 18.78, SAFE)))
    shape = Field(-4.0, 4.0, 2.0, np.zeros(1), obstacle)
    ends = []
    for step in (1.0, 0.5, 0.25):
        x, y = descend(shape, np.zeros(1), np.array([2.0]), 25.0, step, round(60.0 / step))
        np.testing.assert_allclose(np.hypot(np.diff(x[:, 0]), np.diff(y[:, 0])), step)
        ends.append(y[-1, 0])
    assert abs(ends[1] - ends[2]) < 0.35 * abs(ends[0] - ends[1])


def test_a_moving_obstacle_is_where_it_is_when_the_car_is_there() -> None:
    """An obstacle that moves along with the car pushes as one that stands beside it."""
    beside = Obstacles(*(np.array([value]) for value in (0.0, 3.0, 5.0, SAFE, 25.0, 0.0, 1.0)))
    shape = Field(-40.0, 40.0, 2.0, np.zeros(0), beside, Gains(1.0, 0.0))
    now = shape.gradient(np.array([0.0]), np.array([2.0]), 0.0)
    later = shape.gradient(np.array([50.0]), np.array([2.0]), 2.0)
    np.testing.assert_allclose(now, later)


def test_the_curvature_of_a_circle_is_that_of_the_circle() -> None:
    angle = np.linspace(0.0, 1.0, 400)
    bends = curvature(20.0 * np.sin(angle), 20.0 * (1.0 - np.cos(angle)))
    np.testing.assert_allclose(bends[2:-2], 0.05, rtol=1e-3)


@given(st.floats(-10.0, 10.0), st.floats(-50.0, 150.0), st.floats(0.0, 10.0))
def test_the_gradient_is_finite_wherever_the_car_is(across: float, along: float, time: float) -> None:
    shape = _random_field(np.random.default_rng(4), 6)
    for values in shape.gradient(np.array([along]), np.array([across]), time):
        assert np.isfinite(values).all()


def test_beyond_an_edge_the_field_leads_back() -> None:
    shape = Field(-4.0, 4.0, 2.0, np.zeros(0))
    heading = shape.heading(np.zeros(2), np.array([-4.2, 4.2]))
    assert heading[0] > 0.0 > heading[1]
