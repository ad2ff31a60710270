"""Wheels that are turned wrongly, in a closed loop with the plant."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping, wheels
from controllers.interface import Body, Command
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import bend, ego, perception, straight_road

RADIUS = 5.0
ROUND = bend(straight_road(), 0.0, RADIUS, 60.0)
WANTED, FASTEST = 2.2, 4.0
TIMES = np.linspace(0.1, 2.5, 25)


def _turned(now: float, wanted: float) -> FloatArray:
    """Return a plan that turns the wheels as fast as they can."""
    most = CAR_DRIVE.max_steering_rate * TIMES
    return np.asarray(now + np.clip(wanted - now, -most, most))


def _off_the_circle(angle: float, hold_back: bool) -> FloatArray:
    """Return distance from a circle to the left and speed, at every 0.1 s of driving off on it."""
    plant = Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, 0.0)
    plant.steering = angle
    rows = []
    for step in range(50):
        turned = math.atan2(plant.x, RADIUS - plant.y)
        across = RADIUS - math.hypot(plant.x, plant.y - RADIUS)
        heading = math.remainder(plant.heading - turned, 2.0 * math.pi)
        state = ego(plant.speed, across, heading, 0.1, 0.1 * step, steering=plant.steering)
        seen = perception(state, ROUND)
        times = lane_keeping.instants(seen.ego)
        acceleration = np.full(len(times), min(WANTED, FASTEST - plant.speed))
        if hold_back:
            wanted = float(lane_keeping.steering(seen, 0.0, np.zeros(1))[0])
            angles = _turned(plant.steering, wanted)
            acceleration = wheels.held_back(seen.ego, TIMES, angles, acceleration)
        command = Command(times, acceleration, lane_keeping.steering(seen, 0.0, acceleration))
        for part in range(2):
            plant.follow(command, part * 0.05, 0.05)
        rows.append((across, plant.speed))
    return np.array(rows)


def test_an_ego_with_its_wheels_turned_away_stays_on_its_way() -> None:
    rows = _off_the_circle(-0.5, hold_back=True)
    assert np.abs(rows[:, 0]).max() < 0.1
    assert rows[-1, 1] > 3.5
    assert np.abs(_off_the_circle(-0.5, hold_back=False)[:, 0]).max() > 0.6


def test_wheels_that_are_where_the_road_wants_them_hold_nothing_back() -> None:
    angle = math.atan(Body().wheelbase / RADIUS)
    assert _off_the_circle(angle, hold_back=True) == pytest.approx(_off_the_circle(angle, hold_back=False))


def test_wheels_that_turn_gently_hold_nothing_back() -> None:
    gently = 0.3 * TIMES  # half as fast as they can
    assert wheels.held_back(ego(1.0), TIMES, gently, np.array([2.0])).tolist() == [2.0]
    slower = wheels.held_back(ego(1.0), TIMES, 2.0 * gently, np.array([2.0]))
    assert slower.tolist() == [-wheels.BRAKING]
