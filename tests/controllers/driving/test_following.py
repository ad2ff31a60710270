"""Car-following and the speed profile against closed forms, and in a closed loop."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers import catalog
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.following import (
    BEND,
    SPEED_LIMIT,
    Following,
    desired_gap,
    free_acceleration,
)
from controllers.driving.leaders import LANE_END
from controllers.interface import (
    EgoState,
    Neighbour,
    NeighbourGaps,
    Perception,
    Signal,
    SignalState,
)
from tests.controllers.drives import drive
from tests.controllers.scenes import (
    FRONT,
    Car,
    bend,
    ego,
    lanes_that_follow,
    perception,
    straight_road,
)

STYLE = DrivingStyle()


def _first(seen: Perception, target: int = 0) -> tuple[float, str]:
    answer = Following().follow(seen, target, np.zeros(1))
    return float(answer.acceleration[0]), answer.because


def test_a_standing_car_on_a_free_road_accelerates_with_the_model_s_maximum() -> None:
    acceleration, because = _first(perception(ego(0.0)))
    assert acceleration == pytest.approx(STYLE.acceleration)
    assert because == ""


def test_a_car_at_the_limit_keeps_its_speed() -> None:
    assert _first(perception(ego(13.89)))[0] == pytest.approx(0.0, abs=1e-12)


def test_a_car_above_the_limit_brakes_at_most_comfortably() -> None:
    assert -STYLE.deceleration < free_acceleration(40.0, 5.0, STYLE) < 0.0


@pytest.mark.parametrize("speed", [3.0, 8.0, 12.0])
def test_following_is_in_equilibrium_at_the_model_s_gap(speed: float) -> None:
    wanted = STYLE.standstill_gap + STYLE.headway * speed
    gap = wanted / math.sqrt(1.0 - (speed / 13.89) ** 4)
    leader = Car(FRONT + gap + 4.5, 0.0, speed)
    acceleration, because = _first(perception(ego(speed), cars=[leader]))
    assert acceleration == pytest.approx(0.0, abs=1e-9)
    assert because == "car0"


def test_a_closing_speed_is_answered_by_its_kinematic_deceleration() -> None:
    speed, leader, gap = 12.0, 5.0, 40.0
    wanted = desired_gap(speed, leader, STYLE.standstill_gap, STYLE.headway, STYLE)
    assert wanted == pytest.approx(2.5 + 12.0 + 12.0 * 7.0 / (2.0 * math.sqrt(1.8 * 2.0)))
    expected = 1.8 * (1.0 - (12.0 / 13.89) ** 4 - (wanted / gap) ** 2)
    seen = perception(ego(speed), cars=[Car(FRONT + gap + 4.5, 0.0, leader)])
    assert _first(seen)[0] == pytest.approx(expected)


@pytest.mark.parametrize("interval", [0.05, 0.1, 1.0])
@pytest.mark.parametrize("speed", [8.0, 13.0])
def test_a_red_light_is_stopped_at_half_a_metre_before_the_line(speed: float, interval: float) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state, signals=[Signal("tl", 90.0 - travelled, SignalState.RED)])

    rows = drive(catalog.build("aeb"), scene, speed, 40.0, interval)
    assert 90.0 - FRONT - rows[-1, 1] == pytest.approx(STYLE.stop_gap, abs=0.1)
    assert rows[-1, 3] == pytest.approx(0.0, abs=0.01)
    assert rows[:, 4].min() > -3.0


@pytest.mark.parametrize("interval", [0.1, 1.0])
def test_a_slow_leader_is_approached_comfortably_and_never_touched(interval: float) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state, cars=[Car(80.0 + 5.0 * state.time - travelled, 0.0, 5.0)])

    rows = drive(catalog.build("aeb"), scene, 13.0, 60.0, interval)
    gaps = 80.0 + 5.0 * rows[:, 0] - 4.5 - FRONT - rows[:, 1]
    equilibrium = (2.5 + 5.0) / math.sqrt(1.0 - (5.0 / 13.89) ** 4)
    assert gaps[-1] == pytest.approx(equilibrium, abs=0.05)
    assert gaps.min() > equilibrium - 0.2
    assert rows[:, 4].min() > -2.5


@pytest.mark.parametrize("interval", [0.1, 1.0])
def test_a_lower_limit_is_met_where_it_begins(interval: float) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        road = replace(
            straight_road(), limit_along=np.array([-500.0, 100.0 - travelled]), limit=np.array([13.89, 8.33])
        )
        return perception(state, road)

    rows = drive(catalog.build("aeb"), scene, 13.0, 20.0, interval)
    at_the_sign = rows[np.argmax(rows[:, 1] + FRONT >= 100.0), 3]
    assert at_the_sign < 8.33 + 0.3
    assert rows[-1, 3] == pytest.approx(8.33, abs=0.1)
    assert rows[:, 4].min() > -2.5


def test_a_bend_is_entered_at_its_lateral_acceleration() -> None:
    follower = Following()
    speed, place = 13.0, 0.0
    while place < 80.0:
        seen = perception(ego(speed), bend(straight_road(), 80.0 - place, 12.0, 20.0))
        speed += 0.1 * float(follower.follow(seen, 0, np.zeros(1)).acceleration[0])
        place += 0.1 * speed
    assert speed == pytest.approx(math.sqrt(STYLE.lateral_acceleration * 12.0), abs=0.4)


def test_what_mattered_most_is_named() -> None:
    slower = replace(straight_road(), limit_along=np.array([-5.0, 30.0]), limit=np.array([13.89, 5.0]))
    assert _first(perception(road=slower))[1] == SPEED_LIMIT
    assert _first(perception(road=bend(straight_road(), 15.0, 8.0, 10.0)))[1] == BEND
    assert _first(perception(signals=[Signal("tl", 30.0, SignalState.RED)]))[1] == "tl"
    ending = lanes_that_follow(straight_road(2), {0: 40.0})
    assert _first(perception(road=ending))[1] == LANE_END


def test_a_lane_end_behind_the_route_s_end_does_not_matter() -> None:
    ending = replace(lanes_that_follow(straight_road(1), {0: 40.0}), route_end=30.0)
    assert _first(perception(ego(13.89), road=ending))[1] == ""


def test_the_leader_in_the_target_lane_is_followed_too() -> None:
    cars = [Car(25.0, 3.5, 4.0)]
    assert _first(perception(road=straight_road(2), cars=cars), target=0)[1] == ""
    assert _first(perception(road=straight_road(2), cars=cars), target=1)[1] == "car0"


@settings(deadline=None, max_examples=150)
@given(
    speed=st.floats(0.0, 60.0),
    gap=st.floats(-10.0, 200.0),
    leader=st.floats(0.0, 60.0),
    braking=st.floats(-9.0, 3.0),
    stop=st.floats(-20.0, 200.0),
    limit=st.floats(0.0, 40.0),
    radius=st.floats(1.0, 1e6),
)
def test_accelerations_are_finite_and_possible(
    speed: float, gap: float, leader: float, braking: float, stop: float, limit: float, radius: float
) -> None:
    seen = perception(
        ego(speed, plan_interval=1.0),
        bend(straight_road(limit=limit), 5.0, radius, 30.0),
        cars=[Car(FRONT + gap + 4.5, 0.0, leader, acceleration=braking)],
        signals=[Signal("tl", stop, SignalState.RED)],
    )
    result = Following().follow(seen, 0, lane_keeping.instants(seen.ego)).acceleration
    assert np.isfinite(result).all()
    assert result.min() >= -seen.ego.drive.max_deceleration
    assert result.max() <= seen.ego.drive.max_acceleration


def test_a_standing_vehicle_that_only_juts_out_is_driven_past_slowly() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state, cars=[Car(84.5 - travelled, 2.2, 0.0)] if travelled < 90.0 else [])

    def within_the_lane(state: EgoState, travelled: float) -> Perception:
        seen = scene(state, travelled)
        # The body reaches into the lane, so that the world names it as the vehicle ahead.
        ahead = Neighbour("car0", 80.0 - travelled - FRONT, 0.0, 0.0, 4.5)
        return replace(seen, gaps=NeighbourGaps(ahead=ahead if travelled < 88.0 else None))

    rows = drive(catalog.build("aeb"), within_the_lane, 12.0, 25.0)
    beside = rows[(rows[:, 1] + FRONT > 80.0) & (rows[:, 1] - 0.95 < 84.5)]
    assert beside[:, 3].max() < 4.6
    assert beside[:, 3].min() > 2.0
    assert rows[:, 4].min() > -3.0
    assert rows[-1, 3] > 10.0
