"""Plans with a limited jerk: the same end, the same bounds, and safety before comfort."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.jerk_limit import plan_with_jerk_limit
from controllers.speed_plans.trapezoid_profile import PlannedSpeed, PlanningLimits, Situation, plan_trapezoid

LIMITS = PlanningLimits(1.723, 0.6944, 8.0, 11.111, 0.3, 2.5)


def _largest_jerk(plan: PlannedSpeed) -> float:
    return max((abs(one.jerk) for one in plan.profile.segments), default=0.0)


def test_without_a_limit_the_plan_is_the_plain_one() -> None:
    situation = Situation(60.0, 10.0, 5.0)
    plan = plan_with_jerk_limit(plan_intermediate, situation, LIMITS, math.inf, 0.0)
    assert plan == plan_intermediate(situation, LIMITS)


@pytest.mark.parametrize("jerk", [0.5, 1.0, 3.0, 10.0])
def test_random_states_end_at_the_gap_and_speed_as_without_a_limit(jerk: float) -> None:
    drawn = np.random.default_rng(3)
    top = LIMITS.top_speed
    limited = 0
    for gap, speed, other, before in drawn.uniform((2.5, 0.0, 0.5, -0.69), (150.0, top, top, 1.7), (600, 4)):
        situation = Situation(gap, speed, other)
        plan = plan_with_jerk_limit(plan_intermediate, situation, LIMITS, jerk, before)
        plain = plan_intermediate(situation, LIMITS)
        if not plain.safe:
            continue
        time, way, end = plan.profile.knots()[-1]
        assert end == pytest.approx(other, abs=1e-6)
        assert gap + other * time - way == pytest.approx(safe_distance(other, LIMITS), abs=1e-6)
        assert all(one.duration >= 0.0 for one in plan.profile.segments)
        speeds = plan.profile.sampled(np.linspace(0.0, time, 50))[1]
        assert speeds.min() >= 0.0
        assert plan.profile.least_gap(gap, other) >= min(1.25, plain.profile.least_gap(gap, other)) - 1e-5
        if plan.case.endswith("j"):
            limited += 1
            assert _largest_jerk(plan) <= jerk * (1.0 + 1e-5)
            assert plan.profile.segments[0].acceleration == pytest.approx(before)
            assert plan.profile.speed == pytest.approx(speed, abs=1e-9)
    assert limited > 400


def test_a_classic_plan_can_be_smooth_too() -> None:
    plan = plan_with_jerk_limit(plan_trapezoid, Situation(120.0, 5.0), LIMITS, 1.0, 0.0)
    _, way, end = plan.profile.knots()[-1]
    assert end == pytest.approx(0.0, abs=1e-6)
    # The window's part of the way is not shortened by α V of the state that it is planned from.
    assert 120.0 - way >= LIMITS.standoff - 1e-6
    assert _largest_jerk(plan) <= 1.0 + 1e-5


def test_an_emergency_is_not_softened() -> None:
    situation = Situation(9.0, 11.0, 0.0)
    plain = plan_intermediate(situation, LIMITS)
    plan = plan_with_jerk_limit(plan_intermediate, situation, LIMITS, 1.0, 0.0)
    assert plan.profile.least_gap(9.0, 0.0) >= min(1.25, plain.profile.least_gap(9.0, 0.0)) - 1e-5


def test_the_last_metres_of_a_stop_may_exceed_the_limit_rather_than_drive_backwards() -> None:
    # From 2 m/s^2 at 0.5 m/s no jerk below 4 m/s^3 keeps the speed positive.
    plan = plan_with_jerk_limit(plan_intermediate, Situation(3.0, 0.5, 0.0), LIMITS, 1.0, -2.0)
    assert _largest_jerk(plan) >= 4.0 - 1e-6 or plan.profile.segments[0].jerk == 0.0
    assert plan.profile.sampled(np.linspace(0.0, 5.0, 100))[1].min() >= 0.0


@settings(deadline=None, max_examples=400)
@given(
    gap=st.floats(-5.0, 300.0),
    speed=st.floats(0.0, 40.0),
    other=st.floats(-5.0, 40.0),
    jerk=st.floats(0.01, 100.0),
    before=st.floats(-8.0, 2.6),
)
@example(gap=0.0, speed=5e-324, other=-1.0, jerk=1.0, before=5e-324)  # a window of no length
def test_whatever_there_is_a_plan_is_finite(
    gap: float, speed: float, other: float, jerk: float, before: float
) -> None:
    plan = plan_with_jerk_limit(plan_intermediate, Situation(gap, speed, other), LIMITS, jerk, before)
    for one in plan.profile.segments:
        assert math.isfinite(one.duration + one.acceleration + one.jerk)
        assert one.duration >= 0.0
        for acceleration in (one.acceleration, one.acceleration + one.jerk * one.duration):
            assert -8.0 - 1e-6 <= acceleration <= 2.6 + 1e-6
    assert all(math.isfinite(value) and value >= 0.0 for knot in plan.profile.knots() for value in knot)
