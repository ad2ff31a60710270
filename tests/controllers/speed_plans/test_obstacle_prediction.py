"""What obstacles are expected to do: braking leaders, pedestrians who leave."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.obstacle_prediction import (
    BRAKING_FOR,
    expected_obstacle,
    plan_for_braking,
    plan_until_gone,
)
from controllers.speed_plans.trapezoid_profile import PlanningLimits, Situation

LIMITS = PlanningLimits(1.8, 2.0, 8.0, 13.0, 0.0, 2.5)


def test_an_obstacle_that_brakes_ends_on_the_expected_line() -> None:
    situation, braking = Situation(40.0, 12.0, 10.0), -3.0
    expected = expected_obstacle(situation, braking)
    assert expected.obstacle_speed == pytest.approx(10.0 - 3.0 * BRAKING_FOR)
    for time in (BRAKING_FOR, 5.0):
        place = (
            40.0 + 10.0 * BRAKING_FOR - 1.5 * BRAKING_FOR**2 + expected.obstacle_speed * (time - BRAKING_FOR)
        )
        assert expected.gap + expected.obstacle_speed * time == pytest.approx(place)


def test_it_is_not_expected_to_drive_backwards() -> None:
    expected = expected_obstacle(Situation(40.0, 12.0, 2.0), -4.0)
    assert expected.obstacle_speed == 0.0
    assert expected.gap == pytest.approx(40.5)


def test_the_plan_for_a_braking_obstacle_ends_at_the_safe_distance_it_will_have() -> None:
    plan = plan_for_braking(plan_intermediate, Situation(60.0, 12.0, 10.0), LIMITS, -2.0)
    time, way, end = plan.profile.knots()[-1]
    place = 60.0 + 10.0 * 2.0 - 4.0 + 6.0 * (time - 2.0)
    assert end == pytest.approx(6.0)
    assert place - way == pytest.approx(safe_distance(6.0, LIMITS))


@settings(deadline=None, max_examples=300)
@given(
    gap=st.floats(3.0, 120.0),
    speed=st.floats(0.0, 13.0),
    other=st.floats(0.1, 13.0),
    braking=st.floats(0.2, 8.0),
)
def test_while_the_obstacle_brakes_it_is_not_run_into_where_that_can_be_avoided(
    gap: float, speed: float, other: float, braking: float
) -> None:
    situation = Situation(gap, speed, other)
    plan = plan_for_braking(plan_intermediate, situation, LIMITS, -braking)
    lasts = min(BRAKING_FOR, other / braking)
    times = np.linspace(0.0, lasts, 50)
    gaps = gap + other * times - 0.5 * braking * times**2 - plan.profile.sampled(times)[0]
    if gaps.min() < 1.0:
        # Then it is the plan that does without the expectation.
        assert plan == plan_intermediate(situation, LIMITS)


def test_who_leaves_in_time_is_not_stopped_for() -> None:
    plan = plan_until_gone(plan_intermediate, Situation(40.0, 12.0), LIMITS, 1.0, 45.0)
    assert plan.case == "gone"
    assert min(speed for _, _, speed in plan.profile.knots()) >= 12.0


@pytest.mark.parametrize("gone", [3.5, 4.0, 5.0])
def test_it_arrives_when_the_obstacle_has_gone(gone: float) -> None:
    situation = Situation(40.0, 12.0)
    plan = plan_until_gone(plan_intermediate, situation, LIMITS, gone, 46.0)
    moved, speed, _ = plan.profile.at(gone)
    assert plan.case == "gone"
    assert moved <= 37.5 + 1e-9
    assert 0.0 < speed < 12.0
    assert plan.profile.final_speed == pytest.approx(LIMITS.top_speed)
    # Should the pedestrian stay after all, the ego can stop in time at any moment.
    for time in np.linspace(0.0, gone, 60):
        way, mine, _ = plan.profile.at(float(time))
        assert way + mine**2 / 16.0 <= 46.0


def test_who_stays_is_stopped_for() -> None:
    situation = Situation(40.0, 12.0)
    plan = plan_until_gone(plan_intermediate, situation, LIMITS, 60.0, 46.0)
    assert plan == plan_intermediate(situation, LIMITS)
    assert plan.profile.knots()[-1][1] == pytest.approx(37.5)
