"""Trapezoidal braking and cubic speeds: closed forms, bounds, and another closed form as the judge."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as some
from scipy.integrate import quad

from controllers.drivable_area.braking_profile import (
    SmoothBraking,
    TrapezoidalBraking,
    longest_duration,
    shortest_duration,
)
from controllers.safety.emergency_braking import stopping_distance

SPEEDS = some.floats(0.1, 40.0)
SHARES = some.floats(0.0, 1.0)
BRAKES = some.floats(2.0, 9.0)
TIMES = np.linspace(0.0, 25.0, 501)


def _braking(speed: float, share: float, limit: float, ramp: float = 0.2) -> TrapezoidalBraking:
    return TrapezoidalBraking(speed, share * speed, limit, 0.1, ramp)


@given(SPEEDS, BRAKES)
def test_a_trapezoid_to_standstill_is_the_stopping_distance_of_the_emergency_brake(
    speed: float, limit: float
) -> None:
    assume(speed > 0.5 * limit * 0.2)
    assert _braking(speed, 0.0, limit).distance == pytest.approx(
        stopping_distance(speed, limit, 0.1, 0.2), abs=1e-9
    )


@given(SPEEDS, BRAKES)
def test_so_it_is_where_the_ramp_is_enough(speed: float, limit: float) -> None:
    expected = stopping_distance(speed, limit, 0.1, 30.0)
    assume(speed < 0.5 * limit * 30.0)
    assert _braking(speed, 0.0, limit, 30.0).distance == pytest.approx(expected, rel=1e-9)


@given(SPEEDS, SHARES, BRAKES)
def test_a_trapezoid_falls_from_the_first_to_the_final_speed(
    speed: float, share: float, limit: float
) -> None:
    braking = _braking(speed, share, limit)
    velocity = braking.velocity(TIMES)
    assert velocity[0] == speed
    assert (np.diff(velocity) <= 1e-9).all()
    assert velocity.min() >= share * speed - 1e-9
    after = braking.ends <= TIMES
    np.testing.assert_allclose(velocity[after], share * speed, atol=1e-9)
    assert (-np.diff(velocity) / np.diff(TIMES)).max() <= limit + 1e-9


@given(SPEEDS, SHARES, BRAKES, some.floats(0.1, 8.0))
def test_positions_are_the_integral_of_the_speed(
    speed: float, share: float, limit: float, time: float
) -> None:
    braking = _braking(speed, share, limit)
    corners = [0.1, 0.1 + braking.ramp_time, braking.ends]
    driven, _ = quad(
        lambda t: float(braking.velocity(np.array([t]))[0]), 0.0, time, points=corners, limit=200
    )
    assert float(braking.position(np.array([time]))[0]) == pytest.approx(driven, abs=1e-5)


@given(SPEEDS, some.floats(0.1, 1.0), BRAKES, some.floats(0.0, 60.0))
def test_a_place_is_reached_when_the_position_says_so(
    speed: float, share: float, limit: float, place: float
) -> None:
    braking = _braking(speed, share, limit)
    arrival = braking.arrival(place)
    assert float(braking.position(np.array([arrival]))[0]) == pytest.approx(place, abs=1e-3)


def test_a_place_beyond_a_stop_is_never_reached() -> None:
    assert _braking(10.0, 0.0, 8.0).arrival(30.0) == math.inf


def _smooth(speed: float, final: float, begin: float, duration: float) -> SmoothBraking:
    return SmoothBraking(*(np.array([value]) for value in (speed, final, begin, duration)))


@given(SPEEDS, SHARES, BRAKES, some.floats(-1.0, 0.3))
def test_a_shortest_cubic_brakes_to_the_final_speed_within_the_limit(
    speed: float, share: float, limit: float, begin_share: float
) -> None:
    final, begin = share * speed, begin_share * limit
    duration = float(shortest_duration(speed, np.array([final]), begin, limit)[0])
    cubic = _smooth(speed, final, begin, duration)
    assume(duration > 1e-6)
    times = np.linspace(0.0, 1.5 * duration, 301)
    position, velocity, change = (one[0] for one in cubic.at(times[None, :]))
    assert change.min() == pytest.approx(-limit, rel=1e-3)
    assert change.min() >= -limit - 1e-6
    assert velocity.min() >= final - 1e-6
    assert velocity[-1] == final
    assert (np.diff(position) >= -1e-9).all()
    assert float(np.interp(duration, times, position)) == pytest.approx(float(cubic.distance[0]), abs=1e-3)


@given(SPEEDS, SHARES, BRAKES, some.floats(-1.0, -0.01), SHARES)
def test_between_shortest_and_longest_a_cubic_never_undershoots(
    speed: float, share: float, limit: float, begin_share: float, between: float
) -> None:
    final, begin = np.array([share * speed]), begin_share * limit
    shortest = shortest_duration(speed, final, begin, limit)
    longest = longest_duration(speed, final, begin)
    assert longest[0] >= shortest[0] - 1e-9
    duration = float(shortest[0] + between * (longest[0] - shortest[0]))
    assume(duration > 1e-6)
    times = np.linspace(0.0, duration, 201)[None, :]
    _, velocity, change = _smooth(speed, float(final[0]), begin, duration).at(times)
    assert velocity.min() >= final[0] - 1e-6 * speed
    assert velocity.min() >= -1e-6
    assert change.min() >= -limit - 1e-6


@given(SPEEDS, SHARES, some.floats(-3.0, 2.0), some.floats(0.2, 8.0))
def test_cubic_speed_and_place_are_integrals(speed: float, share: float, begin: float, lasts: float) -> None:
    cubic = _smooth(speed, share * speed, begin, lasts)
    times = np.linspace(0.0, 1.4 * lasts, 15)
    h = 1e-5
    before, now, after = (cubic.at((times + shift)[None, :]) for shift in (-h, 0.0, h))
    inside = (times > 2 * h) & (np.abs(times - lasts) > 2 * h)
    np.testing.assert_allclose((after[0] - before[0])[0, inside] / (2 * h), now[1][0, inside], atol=1e-4)
    np.testing.assert_allclose((after[1] - before[1])[0, inside] / (2 * h), now[2][0, inside], atol=1e-4)


@given(SPEEDS, SHARES, BRAKES)
def test_from_no_acceleration_the_shortest_is_one_and_a_half_of_full_braking(
    speed: float, share: float, limit: float
) -> None:
    duration = shortest_duration(speed, np.array([share * speed]), 0.0, limit)
    assert float(duration[0]) == pytest.approx(1.5 * (1.0 - share) * speed / limit)
    assert float(_smooth(speed, share * speed, 0.0, float(duration[0])).distance[0]) == pytest.approx(
        0.5 * (1.0 + share) * speed * float(duration[0])
    )


def test_a_smooth_braking_arrives_where_it_is_then() -> None:
    """From 10 to 4 m/s in 2 s: 14 m, and 8 m more at 4 m/s take 2 s. One that stops after 15 m never arrives."""
    speeds = SmoothBraking(np.full(2, 10.0), np.array([4.0, 0.0]), np.zeros(2), np.array([2.0, 3.0]))
    np.testing.assert_allclose(speeds.arrival(22.0), [4.0, np.inf])
    early = speeds.arrival(9.0)
    position, _, _ = speeds.at(early[:, None])
    np.testing.assert_allclose(position[:, 0], 9.0, atol=1e-3)
