"""Profiles of constant acceleration or jerk: closed forms against each other and against small steps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.speed_plans.speed_profile import Segment, SpeedProfile, anticipated, smoothed

DRAWN = np.random.default_rng(4)


def _drawn(jerky: bool) -> SpeedProfile:
    """Return a profile whose speed stays positive."""
    pieces = []
    for _ in range(int(DRAWN.integers(1, 6))):
        jerk = float(DRAWN.uniform(-0.4, 0.4)) if jerky else 0.0
        pieces.append(Segment(float(DRAWN.uniform(0.05, 3.0)), float(DRAWN.uniform(-0.8, 1.5)), jerk))
    return SpeedProfile(float(DRAWN.uniform(20.0, 25.0)), tuple(pieces))


@pytest.mark.parametrize("jerky", [False, True])
def test_distance_and_speed_are_the_integrals_of_the_acceleration(jerky: bool) -> None:
    for _ in range(6):
        profile = _drawn(jerky)
        step = 1e-3
        times = np.arange(0.0, profile.duration + 1.0, step)
        _, _, acceleration = profile.sampled(times + 0.5 * step)
        distance, speed, _ = profile.sampled(times)
        by_steps = profile.speed + np.concatenate(([0.0], np.cumsum(acceleration[:-1]) * step))
        np.testing.assert_allclose(speed, by_steps, atol=2e-3)
        middle = profile.sampled(times + 0.5 * step)[1]
        np.testing.assert_allclose(distance[1:], np.cumsum(middle[:-1]) * step, atol=1e-3)


def test_after_its_end_the_speed_stays() -> None:
    profile = SpeedProfile(4.0, (Segment(2.0, 1.0),))
    assert profile.at(5.0) == (4.0 * 2.0 + 2.0 + 6.0 * 3.0, 6.0, 0.0)
    assert profile.final_speed == 6.0
    assert profile.duration == 2.0


@pytest.mark.parametrize("jerky", [False, True])
def test_the_time_at_a_distance_is_the_inverse(jerky: bool) -> None:
    for _ in range(50):
        profile = _drawn(jerky)
        for time in DRAWN.uniform(0.0, profile.duration + 2.0, 5):
            assert profile.time_at(profile.at(float(time))[0]) == pytest.approx(float(time), abs=1e-7)


def test_over_the_distance_the_speed_is_a_square_root() -> None:
    # V_e = sqrt(V_0^2 + 2 a ds), the form of the plan over the way.
    profile = SpeedProfile(9.0, (Segment(6.0, -1.1),))
    for way in np.linspace(0.0, 30.0, 31):
        speed = profile.at(profile.time_at(float(way)))[1]
        assert speed == pytest.approx(math.sqrt(81.0 - 2.2 * way), abs=1e-9)


def test_what_is_never_reached_has_no_time() -> None:
    stop = SpeedProfile(2.0, (Segment(2.0, -1.0),))
    assert stop.time_at(2.0 + 1e-6) == math.inf
    assert stop.time_at(-1.0) == 0.0


@pytest.mark.parametrize("jerky", [False, True])
def test_the_rest_of_a_profile_goes_on_where_it_was(jerky: bool) -> None:
    for _ in range(30):
        profile = _drawn(jerky)
        begin = float(DRAWN.uniform(0.0, profile.duration + 0.5))
        rest = profile.rest(begin)
        for time in (0.0, 0.3, 1.7, 9.0):
            distance, speed, acceleration = profile.at(begin + time)
            assert rest.at(time) == pytest.approx((distance - profile.at(begin)[0], speed, acceleration))


@pytest.mark.long
@pytest.mark.parametrize("jerky", [False, True])
def test_the_least_gap_is_the_smallest_of_many(jerky: bool) -> None:
    for _ in range(60):
        profile = _drawn(jerky)
        other = profile.final_speed + float(DRAWN.uniform(0.0, 2.0))
        times = np.linspace(0.0, profile.duration + 1.0, 4001)
        gaps = 30.0 + other * times - profile.sampled(times)[0]
        assert profile.least_gap(30.0, other) == pytest.approx(gaps.min(), abs=1e-4)
        assert profile.least_gap(30.0, other) <= gaps.min() + 1e-9


def test_behind_something_slower_the_gap_has_no_least() -> None:
    assert SpeedProfile(5.0).least_gap(100.0, 4.0) == -math.inf


def test_mean_accelerations_lead_to_the_speeds_of_the_profile() -> None:
    profile = SpeedProfile(3.0, (Segment(0.33, 1.5), Segment(0.4, -0.7), Segment(5.0, 0.1)))
    times = np.array([0.0, 0.1, 0.33, 0.5, 0.7])
    found = profile.mean_accelerations(0.2, times, 1.0)
    speeds = profile.sampled(0.2 + np.append(times, 1.0))[1]
    np.testing.assert_allclose(speeds[0] + np.cumsum(found * np.diff(np.append(times, 1.0))), speeds[1:])


ACCELERATION = st.floats(-3.0, 2.0)


@pytest.mark.long
@settings(deadline=None, max_examples=300)
@given(
    speed=st.floats(8.0, 20.0),
    before=ACCELERATION,
    window=st.floats(0.05, 3.0),
    pieces=st.lists(st.tuples(st.floats(0.0, 2.0), ACCELERATION), max_size=4),
)
def test_a_smooth_profile_begins_and_ends_as_it_should_within_bounds(
    speed: float, before: float, window: float, pieces: list[tuple[float, float]]
) -> None:
    start, ahead = anticipated(speed, window, before)
    plain = SpeedProfile(start, tuple(Segment(*one) for one in pieces))
    smooth = smoothed(plain, window, before)
    lowest = min(one[2] for one in plain.knots())
    if lowest < 0.5 or start < 0.5:
        return
    assert smooth.at(0.0)[1] == pytest.approx(speed, abs=1e-9)
    if smooth.segments:
        assert smooth.segments[0].acceleration == before
    end = smooth.duration + 1.0
    assert smooth.final_speed == pytest.approx(plain.final_speed, abs=1e-8)
    # The mean over the window of where the plain one was: half a window behind at the end.
    wanted = plain.at(end)[0] + ahead - 0.5 * window * plain.final_speed
    assert smooth.at(end)[0] == pytest.approx(wanted, abs=1e-6)
    values = [before, 0.0, *(acceleration for _, acceleration in pieces)]
    slack = 1e-7
    highest = max(start, *(one[2] for one in plain.knots()), speed)
    for time in np.linspace(0.0, end, 200):
        _, there, acceleration = smooth.at(float(time))
        assert min(values) - slack <= acceleration <= max(values) + slack
        assert min(lowest, speed) - slack <= there <= highest + slack
    for one in smooth.segments:
        assert one.duration >= 0.0
        assert abs(one.jerk) <= (max(values) - min(values)) / window + slack


def test_without_a_window_nothing_is_smooth() -> None:
    profile = SpeedProfile(3.0, (Segment(1.0, 1.0),))
    assert smoothed(profile, 0.0) is profile
