"""Times of contact against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.geometry.contact_times import box_contact_times, disc_contact_times, sampled_contact_times

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


def test_a_straight_path_in_samples_is_met_when_the_straight_line_is() -> None:
    drawn = np.random.default_rng(5)
    count, times = 600, np.linspace(0.0, 5.0, 26)
    x, y = drawn.uniform(-15.0, 15.0, count), drawn.uniform(-10.0, 10.0, count)
    x_speed, y_speed = drawn.uniform(-8.0, 8.0, count), drawn.uniform(-4.0, 4.0, count)
    radius = drawn.uniform(0.1, 1.0, count)
    wanted = disc_contact_times(REAR, FRONT, SIDE, x, y, x_speed, y_speed, radius)
    found, interval = sampled_contact_times(
        REAR,
        FRONT,
        SIDE,
        times,
        x[:, None] + x_speed[:, None] * times,
        y[:, None] + y_speed[:, None] * times,
        np.repeat(radius[:, None], len(times), axis=1),
    )
    np.testing.assert_allclose(found, wanted, atol=1e-9)
    met = np.isfinite(found)
    assert np.count_nonzero(met) > 50
    assert (times[interval[met]] <= found[met] + 1e-9).all()
    assert (found[met] <= np.append(times, np.inf)[interval[met] + 1] + 1e-9)[interval[met] < 24].all()


def test_a_bent_path_is_met_when_small_steps_meet_it() -> None:
    drawn = np.random.default_rng(6)
    times = np.linspace(0.0, 4.0, 9)
    x = 9.0 + np.cumsum(drawn.uniform(-3.0, 1.0, (100, 9)), axis=1)
    y = 4.0 + np.cumsum(drawn.uniform(-2.0, 1.0, (100, 9)), axis=1)
    radius = np.full_like(x, 0.4)
    found, _ = sampled_contact_times(REAR, FRONT, SIDE, times, x, y, radius)
    fine = np.linspace(0.0, 4.0, 4001)
    for i in range(100):
        path = zip(np.interp(fine, times, x[i]), np.interp(fine, times, y[i]), strict=True)
        touching = np.flatnonzero([_distance(*place) <= 0.4 for place in path])
        if len(touching):
            assert fine[touching[0]] - 0.0011 <= found[i] <= fine[touching[0]] + 1e-9
        else:
            assert not found[i] < 4.0
    assert 20 < np.count_nonzero(found < 4.0) < 90


def test_a_growing_disc_is_met_earlier() -> None:
    times, x = np.array([0.0, 1.0, 2.0]), np.array([[10.0, 8.0, 6.0]])
    small, large = np.zeros((1, 3)) + 0.3, np.array([[0.3, 1.3, 2.3]])
    first, _ = sampled_contact_times(REAR, FRONT, SIDE, times, x, 0.0 * x, small)
    earlier, _ = sampled_contact_times(REAR, FRONT, SIDE, times, x, 0.0 * x, large)
    assert first[0] == pytest.approx((10.0 - FRONT - 0.3) / 2.0)
    assert earlier[0] == pytest.approx((10.0 - FRONT - 2.3) / 2.0)
