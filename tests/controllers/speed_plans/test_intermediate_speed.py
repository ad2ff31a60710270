"""Planning by the intermediate speed: unit values, both closed forms, borders of the cases, many states."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.speed_plans.intermediate_speed import (
    EQUAL,
    intermediate_speed,
    plan_intermediate,
    safe_distance,
)
from controllers.speed_plans.trapezoid_profile import PlannedSpeed, PlanningLimits, Situation

LIMITS = PlanningLimits(1.723, 0.6944, 8.0, 11.111, 0.3, 2.5)
UP, DOWN, TOP = LIMITS.acceleration, LIMITS.deceleration, LIMITS.top_speed
EMERGENCY_ONLY = "no braking is enough"


def _durations(plan: PlannedSpeed) -> list[float]:
    return [one.duration for one in plan.profile.segments]


@pytest.mark.parametrize(
    ("state", "case", "durations"),
    [
        ((60.0, 10.0, 5.0), "2", [0.645, 1.231, 8.801]),
        ((30.0, 10.0, 5.0), "1", [3.2]),
        ((20.0, 2.0, 5.0), "3", [2.192, 1.120]),
        ((10.0, 8.0, 5.0), "5", [10.480, 2.482]),
    ],
)
def test_the_unit_values_of_the_reading(
    state: tuple[float, float, float], case: str, durations: list[float]
) -> None:
    plan = plan_intermediate(Situation(*state), LIMITS)
    assert plan.case == case
    # Rounded to 1 ms there, from parameters that are rounded as well.
    assert _durations(plan) == pytest.approx(durations, abs=1.1e-3)


def test_the_first_case_brakes_with_the_expected_deceleration() -> None:
    plan = plan_intermediate(Situation(30.0, 10.0, 5.0), LIMITS)
    assert plan.profile.segments[0].acceleration == pytest.approx(-1.563, abs=5e-4)


def test_the_two_closed_forms_are_one() -> None:
    drawn = np.random.default_rng(1)
    for gap, speed, other in drawn.uniform((0.0, 0.0, 0.0), (150.0, TOP, TOP), (2000, 3)):
        surplus, relative = gap - safe_distance(other, LIMITS), speed - other
        squared = DOWN * (2.0 * UP * surplus + relative**2) / (UP + DOWN)
        found = intermediate_speed(Situation(gap, speed, other), LIMITS)
        assert found - other == pytest.approx(math.copysign(math.sqrt(abs(squared)), squared), abs=1e-9)


def test_the_intermediate_speed_solves_the_equations_it_comes_from() -> None:
    # Eq. (5): speeding up and slowing down again covers the surplus and what the obstacle moves meanwhile.
    gap, speed, other = 35.0, 4.0, 5.0
    middle = intermediate_speed(Situation(gap, speed, other), LIMITS)
    way = (middle**2 - speed**2) / (2.0 * UP) + (middle**2 - other**2) / (2.0 * DOWN)
    time = (middle - speed) / UP + (middle - other) / DOWN
    assert way == pytest.approx(gap - safe_distance(other, LIMITS) + other * time, abs=1e-9)


def _at_surplus(surplus: float, speed: float, other: float) -> Situation:
    return Situation(surplus + safe_distance(other, LIMITS), speed, other)


@pytest.mark.parametrize(
    ("border", "speed", "other", "value", "cases"),
    [
        (25.0 / (2.0 * DOWN), 10.0, 5.0, 10.0, ("1", "3")),
        (-9.0 / (2.0 * UP), 2.0, 5.0, 5.0, ("4", "3")),
        (-9.0 * (1.0 / UP + 0.5 / DOWN), 2.0, 5.0, 2.0, ("6", "4")),
        (
            ((TOP - 5.0) ** 2 - 25.0) / (2.0 * UP) + (TOP - 5.0) ** 2 / (2.0 * DOWN),
            10.0, 5.0, TOP, ("3", "2"),
        ),
    ],
)  # fmt: skip
def test_the_intermediate_speed_is_continuous_where_the_case_changes(
    border: float, speed: float, other: float, value: float, cases: tuple[str, str]
) -> None:
    tiny = 1e-7
    before, after = (_at_surplus(border + side, speed, other) for side in (-tiny, tiny))
    assert tuple(plan_intermediate(one, LIMITS).case for one in (before, after)) == cases
    speeds = [intermediate_speed(one, LIMITS) for one in (before, after)]
    assert speeds[0] == pytest.approx(speeds[1], abs=1e-3)
    assert speeds[1] == pytest.approx(value, abs=1e-3)
    # What is driven changes as little, except where keeping the speed gives way to falling back.
    driven = [plan_intermediate(one, LIMITS).profile.at(4.0)[0] for one in (before, after)]
    assert (driven[0] == pytest.approx(driven[1], abs=1e-2)) is (cases != ("6", "4"))


def test_at_no_surplus_braking_to_the_obstacle_becomes_falling_back() -> None:
    cases = [plan_intermediate(_at_surplus(at, 6.0, 5.0), LIMITS).case for at in (-0.5, 0.3)]
    assert cases == ["5", "1"]


@pytest.mark.long
def test_twenty_thousand_states_end_at_the_gap_and_speed() -> None:
    drawn = np.random.default_rng(20)
    states = drawn.uniform((0.0, 0.0, 0.0), (150.0, TOP, TOP), (20_000, 3)).tolist()
    least = 0.5 * LIMITS.standoff
    found: Counter[str] = Counter()
    for gap, speed, other in states:
        plan = plan_intermediate(Situation(gap, speed, other), LIMITS)
        knots = plan.profile.knots()
        assert min(_durations(plan), default=0.0) >= 0.0
        assert min(knot[2] for knot in knots) >= 0.0
        if not plan.safe or (gap < least and speed >= other):
            found[EMERGENCY_ONLY] += 1
            continue
        found[plan.case] += 1
        time, way, end = knots[-1]
        assert end == pytest.approx(other, abs=1e-9)
        # Slow obstacles take long: rounding of what they move counts.
        assert gap + other * time - way == pytest.approx(
            safe_distance(other, LIMITS), abs=1e-9 + 1e-12 * other * time
        )
        assert plan.profile.least_gap(gap, other) >= min(least, gap) - 1e-9
    assert set(found) == {"1", "2", "3", "4", "5", "6", EMERGENCY_ONLY}
    assert found[EMERGENCY_ONLY] < 3_000
    assert min(found.values()) > 100


def test_above_the_top_speed_it_brakes_keeps_the_speed_and_brakes() -> None:
    plan = plan_intermediate(Situation(120.0, 14.0, 5.0), LIMITS)
    assert plan.case == "7"
    time, way, end = plan.profile.knots()[-1]
    assert 120.0 + 5.0 * time - way == pytest.approx(safe_distance(5.0, LIMITS), abs=1e-9)
    assert end == pytest.approx(5.0)
    assert [speed for _, _, speed in plan.profile.knots()][1:3] == pytest.approx([TOP, TOP])


def test_behind_something_faster_than_the_top_speed_the_top_speed_is_driven() -> None:
    plan = plan_intermediate(Situation(20.0, 6.0, 15.0), LIMITS)
    assert plan.case == "0"
    assert plan.profile.final_speed == pytest.approx(TOP)


def test_something_faster_than_the_top_speed_is_not_run_into_either() -> None:
    plan = plan_intermediate(Situation(12.0, 20.0, 12.0), LIMITS)
    assert plan.profile.least_gap(12.0, 12.0) >= 0.5 * LIMITS.standoff - 1e-9


def test_a_standing_obstacle_that_is_too_near_is_stood_before() -> None:
    plan = plan_intermediate(Situation(2.0, 0.0, 0.0), LIMITS)
    assert plan.profile.final_speed == 0.0
    assert plan.profile.at(100.0)[0] == 0.0
    moving = plan_intermediate(Situation(5.0, 7.0, 0.0), LIMITS)
    assert moving.profile.least_gap(5.0, 0.0) == pytest.approx(0.5 * LIMITS.standoff)
    assert moving.safe


def test_a_slow_obstacle_that_is_too_near_is_waited_for() -> None:
    plan = plan_intermediate(Situation(2.0, 1.0, 0.5), LIMITS)
    speeds = [speed for _, _, speed in plan.profile.knots()]
    assert speeds[1:3] == [0.0, 0.0]
    assert plan.profile.segments[1].duration > 1.0


def test_what_no_braking_avoids_is_said_to_be_unsafe() -> None:
    plan = plan_intermediate(Situation(4.0, 11.0, 0.0), LIMITS)
    assert not plan.safe
    assert plan.profile.segments[0].acceleration == -LIMITS.emergency_deceleration
    assert plan_intermediate(Situation(0.3, 3.0, 4.0), LIMITS).safe


@pytest.mark.long
@settings(deadline=None, max_examples=1000)
@given(
    gap=st.floats(-20.0, 500.0),
    speed=st.floats(0.0, 60.0),
    other=st.floats(-10.0, 60.0),
    top=st.floats(0.1, 60.0),
    delay=st.floats(0.0, 1.0),
    standoff=st.floats(0.0, 10.0),
    up=st.floats(0.1, 5.0),
    down=st.floats(0.1, 8.0),
)
def test_whatever_there_is_a_plan_is_finite_and_within_the_limits(
    gap: float, speed: float, other: float, top: float, delay: float, standoff: float, up: float, down: float
) -> None:
    limits = PlanningLimits(up, down, 8.0, top, delay, standoff)
    plan = plan_intermediate(Situation(gap, speed, other), limits)
    for one in plan.profile.segments:
        assert math.isfinite(one.duration)
        assert one.duration >= 0.0
        assert -limits.emergency_deceleration - 1e-9 <= one.acceleration <= up
    knots = plan.profile.knots()
    assert all(math.isfinite(value) for knot in knots for value in knot)
    assert max(knot[2] for knot in knots) <= max(speed, top, min(other, top)) + 1e-6
    closing = speed > max(other, 0.0)
    if plan.safe and closing and 0.0 <= other < top - EQUAL:
        assert plan.profile.least_gap(gap, other) >= 0.5 * standoff - 1e-6


def test_the_safe_distance_grows_with_speed_delay_and_gentleness() -> None:
    assert safe_distance(5.0, LIMITS) == pytest.approx(25.0 / (2.0 * DOWN) + 1.5 + 2.5)
    assert safe_distance(-1.0, LIMITS) == LIMITS.standoff
    assert safe_distance(5.0, replace(LIMITS, deceleration=2.0)) < safe_distance(5.0, LIMITS)
