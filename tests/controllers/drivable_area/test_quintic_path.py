"""Paths of fifth degree: boundary conditions, curvature, and Eq. (14)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from controllers.drivable_area.motions import arc_lengths
from controllers.drivable_area.quintic_path import (
    PathStart,
    curvature,
    quintic_paths,
)

STARTS = some.builds(PathStart, some.floats(-3.0, 3.0), some.floats(-0.4, 0.4), some.floats(-0.1, 0.1))
LENGTHS = some.floats(3.0, 60.0)
OFFSETS = some.lists(some.floats(-4.0, 4.0), min_size=1, max_size=4)


@given(STARTS, LENGTHS, OFFSETS)
def test_paths_begin_and_end_as_asked_for(start: PathStart, length: float, offsets: list[float]) -> None:
    paths = quintic_paths(start, length, np.array(offsets))
    y, slope, bend = paths.at(np.array([[0.0, length]]))
    np.testing.assert_allclose(y[:, 0], start.across, atol=1e-9)
    np.testing.assert_allclose(slope[:, 0], start.slope, atol=1e-9)
    np.testing.assert_allclose(bend[:, 0], start.bend, atol=1e-9)
    np.testing.assert_allclose(y[:, 1], offsets, atol=1e-8)
    np.testing.assert_allclose(slope[:, 1], 0.0, atol=1e-8)
    np.testing.assert_allclose(bend[:, 1], 0.0, atol=1e-8)


@given(LENGTHS, some.floats(-4.0, 4.0))
def test_from_a_straight_start_it_is_the_known_polynomial(length: float, end: float) -> None:
    s = np.linspace(0.0, 1.0, 21)
    y, _, _ = quintic_paths(PathStart(0.5), length, np.array([end])).at(length * s[None, :])
    np.testing.assert_allclose(y[0], 0.5 + (end - 0.5) * (10 * s**3 - 15 * s**4 + 6 * s**5), atol=1e-9)


@given(STARTS, LENGTHS, OFFSETS)
def test_beyond_its_end_the_offset_is_kept(start: PathStart, length: float, offsets: list[float]) -> None:
    y, slope, bend = quintic_paths(start, length, np.array(offsets)).at(
        np.array([[length + 1e-6, 2.0 * length]])
    )
    np.testing.assert_array_equal(y, np.repeat(np.array(offsets)[:, None], 2, axis=1))
    assert not slope.any()
    assert not bend.any()


@given(STARTS, LENGTHS, OFFSETS)
def test_derivatives_and_curvature_agree_with_finite_differences(
    start: PathStart, length: float, offsets: list[float]
) -> None:
    paths = quintic_paths(start, length, np.array(offsets))
    h = 1e-5 * length
    x = np.linspace(0.05, 0.95, 7)[None, :] * length
    before, now, after = (paths.at(x + shift) for shift in (-h, 0.0, h))
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), now[1], atol=1e-6)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), now[2], atol=1e-6)
    # The curvature is what the heading turns by per metre of path.
    turned = np.arctan(after[1]) - np.arctan(before[1])
    driven = np.hypot(2 * h, after[0] - before[0])
    np.testing.assert_allclose(turned / driven, curvature(now[1], now[2]), atol=1e-6)


def test_the_largest_lateral_acceleration_of_a_shift_is_its_closed_form() -> None:
    length, shift, speed = 10.0, 1.1, 40 / 3.6
    _, _, bend = quintic_paths(PathStart(), length, np.array([shift])).at(
        np.linspace(0.0, length, 4001)[None, :]
    )
    largest = 10.0 / math.sqrt(3.0) * shift / length**2
    assert np.abs(bend).max() == pytest.approx(largest, rel=1e-6)
    # 0.8 g allows a shift of 1.10 m in 10 m at 40 km/h.
    assert speed**2 * largest == pytest.approx(0.8 * 9.80665, rel=0.01)


def test_arc_lengths_are_longer_than_the_road_by_half_the_squared_slope() -> None:
    grid = np.linspace(0.0, 20.0, 401)
    paths = quintic_paths(PathStart(), 20.0, np.array([0.0, 1.0]))
    lengths = arc_lengths(paths, grid)
    np.testing.assert_allclose(lengths[0], grid, atol=1e-12)
    # ∫ y′² dx = (10 / 7) shift² / length
    assert lengths[1, -1] - 20.0 == pytest.approx(0.5 * 10.0 / 7.0 / 20.0, rel=0.01)


def test_a_path_without_length_is_refused() -> None:
    with pytest.raises(ValueError, match="length = 0"):
        quintic_paths(PathStart(), 0.0, np.zeros(1))
