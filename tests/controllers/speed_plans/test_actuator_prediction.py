"""The state from which commands act without a delay, against the plant that has one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.interface import Body, constant_command
from controllers.speed_plans.actuator_prediction import CommandHistory, predicted_state
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import ego

LAG = 0.4
DRIVE = replace(CAR_DRIVE, drive_lag=LAG)


@pytest.mark.parametrize("dead_time", [0.0, 0.3])
def test_a_plant_ends_where_the_prediction_says(dead_time: float) -> None:
    # Commands of the last dead time are still to come; afterwards nothing is commanded.
    drawn = np.random.default_rng(8)
    commands = drawn.uniform(-2.0, 2.0, 30)
    history, plant, step = CommandHistory(), Plant(Body(), DRIVE, 0.0, 0.0, 0.0, 12.0), 0.1
    late = round(dead_time / step)
    for i, acceleration in enumerate(commands):
        effective = commands[i - late] if i >= late else 0.0
        history.add(i * step, np.zeros(1), np.array([acceleration]))
        plant.follow(constant_command(float(effective), 0.0), 0.0, step)
    now = len(commands) * step
    seen = ego(plant.speed, 0.0, 0.0, step, now, plant.acceleration, 0.0, DRIVE)
    state = predicted_state(seen, LAG + dead_time, history)
    begin = plant.x
    for acceleration in commands[len(commands) - late :]:
        plant.follow(constant_command(float(acceleration), 0.0), 0.0, step)
    for _ in range(200):
        plant.follow(constant_command(0.0, 0.0), 0.0, step)
    assert plant.speed == pytest.approx(state.speed, abs=1e-6)
    # At a constant speed the plant is behind by the lag, and the clock ahead by the dead time.
    travelled = state.ahead + state.speed * 20.0 - LAG * state.speed
    assert plant.x - begin == pytest.approx(travelled, abs=1e-4)
    assert state.delay == pytest.approx(LAG + dead_time)


def test_a_gap_is_the_one_after_the_delay() -> None:
    state = predicted_state(ego(10.0, limits=DRIVE), LAG, CommandHistory())
    assert state.ahead == pytest.approx(4.0)
    assert state.gap(30.0, 5.0) == pytest.approx(30.0 - 4.0 + 2.0)
    assert state.gap(30.0, 10.0) == pytest.approx(30.0)


def test_a_delay_shorter_than_the_lag_is_the_lag() -> None:
    assert predicted_state(ego(10.0, limits=DRIVE), 0.1, CommandHistory()).delay == pytest.approx(LAG)


def test_ideal_actuators_need_no_prediction() -> None:
    seen = ego(10.0, acceleration=1.0, limits=replace(CAR_DRIVE, drive_lag=0.0))
    state = predicted_state(seen, 0.0, CommandHistory())
    assert (state.speed, state.ahead, state.delay) == (10.0, 0.0, 0.0)


def test_a_stop_in_the_commands_under_way_ends_there() -> None:
    history = CommandHistory()
    history.add(0.0, np.zeros(1), np.array([-8.0]))
    seen = ego(1.0, time=0.5, limits=replace(CAR_DRIVE, drive_lag=0.0))
    state = predicted_state(seen, 0.5, history)
    assert state.speed == 0.0
    assert state.ahead == pytest.approx(1.0 / 16.0)


def test_the_history_knows_what_was_commanded_when() -> None:
    history = CommandHistory()
    assert history.last(3.0) == 0.0
    history.add(0.0, np.array([0.0, 0.5]), np.array([1.0, 2.0]))
    history.add(1.0, np.array([0.0, 0.5]), np.array([3.0, 4.0]))
    assert history.last(1.0) == 2.0
    assert history.since(0.25, 1.25) == [(0.25, 1.0), (0.5, 2.0), (0.25, 3.0)]
    # A new command replaces what an old one said of the time since.
    history.add(1.25, np.zeros(1), np.array([5.0]))
    assert history.last(2.0) == 5.0
    for i in range(200):
        history.add(2.0 + 0.1 * i, np.zeros(1), np.array([float(i)]))
    assert len(history._begins) < 60
    assert history.last(22.0) == 199.0
