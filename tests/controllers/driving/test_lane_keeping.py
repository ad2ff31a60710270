"""Steering in a closed loop with a simulated bicycle."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping
from controllers.interface import Body, Command, RoadAhead
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import LANE_WIDTH, bend, ego, perception, straight_road

RADIUS = 8.0
TURN_BEGINS = 20.0

Place = Callable[[float, float, float], tuple[float, float, float]]


def _straight(x: float, y: float, heading: float) -> tuple[float, float, float]:
    return x, y, heading


def _turn(x: float, y: float, heading: float) -> tuple[float, float, float]:
    """Return along, across, heading error to a straight, a left quarter circle and a straight."""
    if x <= TURN_BEGINS:
        return x, y, heading
    angle = math.atan2(x - TURN_BEGINS, RADIUS - y)
    if angle <= 0.5 * math.pi:
        across = RADIUS - math.hypot(x - TURN_BEGINS, y - RADIUS)
        return TURN_BEGINS + RADIUS * angle, across, math.remainder(heading - angle, 2.0 * math.pi)
    end = TURN_BEGINS + 0.5 * math.pi * RADIUS
    return end + y - RADIUS, TURN_BEGINS + RADIUS - x, math.remainder(heading - 0.5 * math.pi, 2.0 * math.pi)


def _drive(
    road: RoadAhead, speed: float, target: float, interval: float, duration: float, place: Place = _straight
) -> FloatArray:
    """Return time, across and lateral acceleration at every 0.05 s of a drive at constant speed."""
    plant = Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, speed)
    whole = np.pad(road.curvature, (0, 400))
    rows = []
    for step in range(round(duration / interval)):
        along, across, heading = place(plant.x, plant.y, plant.heading)
        seen_road = replace(road, curvature=np.interp(along + np.arange(60), np.arange(len(whole)), whole))
        state = ego(plant.speed, across, heading, interval, step * interval, steering=plant.steering)
        seen = perception(state, seen_road)
        times = lane_keeping.instants(seen.ego)
        nothing = np.zeros(len(times))
        command = Command(times, nothing, lane_keeping.steering(seen, target, nothing))
        for part in range(round(interval / 0.05)):
            plant.follow(command, part * 0.05, 0.05)
            lateral = plant.speed**2 * math.tan(plant.steering) / plant.body.wheelbase
            now = step * interval + (part + 1) * 0.05
            rows.append((now, place(plant.x, plant.y, plant.heading)[1], lateral))
    return np.array(rows)


@pytest.mark.parametrize("interval", [0.05, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("speed", [5.0, 13.9, 25.0])
def test_a_lane_change_takes_four_to_five_seconds_and_does_not_overshoot(
    speed: float, interval: float
) -> None:
    rows = _drive(straight_road(2), speed, LANE_WIDTH, interval, 10.0)
    arrived = rows[np.argmax(rows[:, 1] > LANE_WIDTH - 0.2), 0]
    assert 3.5 <= arrived <= 5.0
    assert rows[:, 1].max() < LANE_WIDTH + 0.02
    assert rows[-1, 1] == pytest.approx(LANE_WIDTH, abs=0.01)
    assert np.abs(rows[:, 2]).max() <= 3.0


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_slow_car_changes_lane_as_well(speed: float) -> None:
    rows = _drive(straight_road(2), speed, LANE_WIDTH, 0.1, 30.0 / speed)
    assert rows[-1, 1] == pytest.approx(LANE_WIDTH, abs=0.05)
    assert rows[:, 1].max() < LANE_WIDTH + 0.02


@pytest.mark.parametrize("interval", [0.05, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("speed", [2.0, 4.0])
def test_a_tight_turn_is_followed_within_a_decimetre(speed: float, interval: float) -> None:
    road = bend(straight_road(), TURN_BEGINS, RADIUS, 0.5 * math.pi * RADIUS)
    rows = _drive(road, speed, 0.0, interval, 44.0 / speed, _turn)
    assert np.abs(rows[:, 1]).max() < 0.1
    assert abs(rows[-1, 1]) < 0.02


def test_a_standing_car_is_given_finite_angles() -> None:
    assert np.isfinite(lane_keeping.steering(perception(ego(0.0, across=2.0)), 0.0, np.zeros(2))).all()


@settings(deadline=None, max_examples=60)
@given(
    st.floats(0.0, 60.0),
    st.floats(-8.0, 8.0),
    st.floats(-3.1, 3.1),
    st.floats(-0.6, 0.6),
    st.floats(-8.0, 3.0),
)
def test_angles_are_always_finite_and_possible(
    speed: float, across: float, heading: float, angle: float, acceleration: float
) -> None:
    seen = perception(ego(speed, across, heading, 1.0, steering=angle), bend(straight_road(), 3.0, 5.0, 9.0))
    times = lane_keeping.instants(seen.ego)
    angles = lane_keeping.steering(seen, 0.0, np.full(len(times), acceleration))
    assert np.isfinite(angles).all()
    assert np.abs(angles).max() <= seen.ego.drive.max_steering
