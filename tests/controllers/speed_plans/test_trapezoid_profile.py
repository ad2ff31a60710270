"""The classic trapezoidal plan: closed forms, and that replanned while driving it stands before an obstacle."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.speed_plans.trapezoid_profile import (
    PlannedSpeed,
    PlanningLimits,
    Situation,
    free_profile,
    plan_trapezoid,
)

LIMITS = PlanningLimits(deceleration=40.0 / 3.6 / 16.0, top_speed=40.0 / 3.6, actuator_delay=0.0)


def _way(plan: PlannedSpeed) -> float:
    return plan.profile.knots()[-1][1]


def test_the_static_experiment_brakes_after_13_s_and_stands_after_29_s() -> None:
    plan = plan_trapezoid(Situation(200.0, 0.0), LIMITS)
    up, cruise, down = (one.duration for one in plan.profile.segments)
    assert up + cruise == pytest.approx(13.0, abs=0.001)
    assert down == pytest.approx(16.0)
    assert _way(plan) == pytest.approx(197.5)


@pytest.mark.parametrize("gap", [4.0, 12.0, 30.0, 91.0, 92.0, 150.0, 400.0])
@pytest.mark.parametrize("speed", [0.0, 0.5, 5.0, 11.1, 40.0 / 3.6, 13.0])
def test_a_plan_uses_the_room_up_exactly(gap: float, speed: float) -> None:
    limits = replace(LIMITS, actuator_delay=0.3)
    plan = plan_trapezoid(Situation(gap, speed), limits)
    room = gap - 0.3 * speed - 2.5
    stop = speed**2 / 16.0
    if room > stop:
        assert _way(plan) == pytest.approx(room, abs=1e-9)
    assert plan.profile.final_speed == pytest.approx(0.0, abs=1e-9)
    assert all(one.duration >= 0.0 for one in plan.profile.segments)


def test_the_highest_speed_of_a_short_plan_is_the_closed_form() -> None:
    up, down = LIMITS.acceleration, LIMITS.deceleration
    plan = plan_trapezoid(Situation(40.0, 3.0), LIMITS)
    highest = ((2.0 * up * down * 37.5 + down * 9.0) / (up + down)) ** 0.5
    assert max(speed for _, _, speed in plan.profile.knots()) == pytest.approx(highest)
    assert plan.case == "peak"


def test_where_comfortable_braking_is_too_late_it_brakes_harder_up_to_the_limit() -> None:
    plan = plan_trapezoid(Situation(22.5, 10.0), LIMITS)
    assert plan.case == "emergency"
    assert plan.profile.segments[0].acceleration == pytest.approx(-100.0 / 40.0)
    late = plan_trapezoid(Situation(3.0, 10.0), LIMITS)
    assert late.profile.segments[0].acceleration == -LIMITS.emergency_deceleration
    assert not late.safe
    assert plan.safe


def test_the_speed_of_the_obstacle_is_not_used() -> None:
    assert plan_trapezoid(Situation(50.0, 8.0, 5.0), LIMITS) == plan_trapezoid(Situation(50.0, 8.0), LIMITS)


@pytest.mark.parametrize("delay", [0.0, 0.3, 0.7])
def test_replanned_while_driving_it_stands_at_the_standoff(delay: float) -> None:
    limits = replace(LIMITS, actuator_delay=delay)
    way, speed = 0.0, 0.0
    for _ in range(600):
        moved, speed, _ = plan_trapezoid(Situation(200.0 - way, speed), limits).profile.at(0.1)
        way += moved
    assert 200.0 - way == pytest.approx(limits.standoff, abs=1e-3)


@pytest.mark.parametrize("speed", [0.0, 5.0, 40.0 / 3.6, 20.0])
def test_with_nothing_ahead_the_top_speed_is_reached(speed: float) -> None:
    profile = free_profile(speed, LIMITS)
    assert profile.final_speed == pytest.approx(LIMITS.top_speed)


@settings(deadline=None, max_examples=500)
@given(st.floats(-5.0, 300.0), st.floats(0.0, 50.0), st.floats(0.1, 50.0))
def test_whatever_there_is_a_plan_is_finite_and_within_the_limits(
    gap: float, speed: float, top: float
) -> None:
    limits = replace(LIMITS, top_speed=top)
    plan = plan_trapezoid(Situation(gap, speed), limits)
    for one in plan.profile.segments:
        assert 0.0 <= one.duration < 1e6
        assert -limits.emergency_deceleration - 1e-9 <= one.acceleration <= limits.acceleration
    assert max(v for _, _, v in plan.profile.knots()) <= max(speed, top) + 1e-9
