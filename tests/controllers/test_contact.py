"""Times of contact against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.prediction.contact import box_contact_times, disc_contact_times

REAR, FRONT, SIDE = -0.95, 3.55, 0.9


def _distance(x: float, y: float) -> float:
    """Return the distance of a point from the rectangle [m]."""
    return math.hypot(max(REAR - x, 0.0, x - FRONT), max(abs(y) - SIDE, 0.0))


def test_contact_times_of_discs_equal_those_of_small_steps() -> None:
    drawn = np.random.default_rng(3)
    count = 200
    x, y = drawn.uniform(-15.0, 15.0, count), drawn.uniform(-10.0, 10.0, count)
    x_speed, y_speed = drawn.uniform(-8.0, 8.0, count), drawn.uniform(-4.0, 4.0, count)
    radius = drawn.uniform(0.1, 1.0, count)
    found = disc_contact_times(REAR, FRONT, SIDE, x, y, x_speed, y_speed, radius)
    for i in range(count):
        if np.isfinite(found[i]):
            touching = _distance(x[i] + x_speed[i] * found[i], y[i] + y_speed[i] * found[i])
            assert touching == pytest.approx(radius[i], abs=1e-9) or (
                found[i] == 0.0 and touching < radius[i]
            )
        until = min(found[i], 6.0)
        before = np.linspace(0.0, until, 100, endpoint=False)[1:] if until > 0.0 else np.zeros(0)
        nearest = [_distance(x[i] + x_speed[i] * t, y[i] + y_speed[i] * t) for t in before]
        assert all(value >= radius[i] - 1e-9 for value in nearest)


def test_a_point_at_rest_is_inside_or_never() -> None:
    zero = np.zeros(2)
    found = box_contact_times(REAR, FRONT, SIDE, np.array([0.0, 5.0]), zero, zero, zero)
    assert found[0] == 0.0
    assert np.isinf(found[1])


def test_somebody_who_moves_away_is_never_met() -> None:
    one = np.ones(1)
    assert np.isinf(disc_contact_times(REAR, FRONT, SIDE, 6.0 * one, 0.0 * one, one, 0.0 * one, 0.3 * one)[0])


def test_nobody_gives_no_times() -> None:
    none = np.zeros(0)
    assert len(disc_contact_times(REAR, FRONT, SIDE, none, none, none, none, none)) == 0
