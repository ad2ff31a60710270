"""The last plan, moved to the present."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Command
from controllers.velocity_obstacle.mpc.plan_memory import FORGOTTEN_AFTER, PlanMemory, sampled_command
from tests.controllers.scenes import ego

TIMES = np.array([0.5, 1.0, 2.0])


def _memory(acceleration: float = 1.0) -> PlanMemory:
    """A plan made at 10 s: from 10 m/s with 1 m/s^2."""
    memory = PlanMemory(TIMES)
    command = Command(
        np.array([0.0, 0.3, 0.6]), np.array([acceleration, 0.5, -2.0]), np.array([0.0, 0.01, 0.02])
    )
    memory.keep(10.0, command, 10.0 * TIMES + 0.5 * TIMES**2, 10.0 + TIMES, np.array([0.1, 0.5, 1.0]))
    return memory


def test_without_a_plan_the_present_speed_is_expected_to_last() -> None:
    memory = PlanMemory(TIMES)
    position, speed = memory.expected(ego(speed=7.0))
    assert position == pytest.approx(7.0 * TIMES)
    assert speed == pytest.approx([7.0] * 3)
    assert memory.age(3.0) == np.inf
    assert memory.rest(3.0) is None
    assert memory.commanded(ego(acceleration=0.4, steering=0.1)) == (0.4, 0.1)
    assert memory.shifted_by(1.0) == np.inf


def test_a_plan_of_this_instant_is_expected_as_it_is() -> None:
    position, speed = _memory().expected(ego(time=10.0))
    assert position == pytest.approx(10.0 * TIMES + 0.5 * TIMES**2)
    assert speed == pytest.approx(10.0 + TIMES)


def test_an_older_plan_is_shifted_by_its_age_and_begins_at_zero() -> None:
    position, speed = _memory().expected(ego(time=10.5))
    travelled = 10.0 * 0.5 + 0.125
    assert position[0] == pytest.approx(10.5 - travelled)
    assert speed[:2] == pytest.approx([11.0, 11.5])
    # Beyond the horizon the last speed lasts.
    assert position[2] == pytest.approx(22.0 + 0.5 * 12.0 - travelled)
    assert speed[2] == pytest.approx(12.0)


def test_a_plan_that_is_too_old_is_no_guide() -> None:
    position, _ = _memory().expected(ego(speed=3.0, time=10.0 + FORGOTTEN_AFTER + 0.01))
    assert position == pytest.approx(3.0 * TIMES)


@pytest.mark.parametrize(
    ("time", "acceleration", "steering"),
    [(10.0, 1.0, 0.0), (10.29, 1.0, 0.0), (10.3, 0.5, 0.01), (10.7, -2.0, 0.02), (99.0, -2.0, 0.02)],
)
def test_what_is_commanded_is_the_entry_of_this_instant(
    time: float, acceleration: float, steering: float
) -> None:
    assert _memory().commanded(ego(time=time)) == (acceleration, steering)


def test_a_vehicle_that_does_something_else_altogether_has_left_the_command_behind() -> None:
    assert _memory().commanded(ego(time=10.0, acceleration=-3.5))[0] == -3.5
    assert _memory().commanded(ego(time=10.0, acceleration=-2.5))[0] == 1.0
    assert _memory().commanded(ego(time=10.0, steering=0.5))[1] == 0.5
    assert _memory().commanded(ego(time=10.0, steering=0.1))[1] == 0.0


def test_the_rest_of_a_command_goes_on_where_it_is() -> None:
    rest = _memory().rest(10.4)
    assert rest is not None
    assert rest.times == pytest.approx([0.0, 0.2])
    assert rest.acceleration.tolist() == [0.5, -2.0]


def test_a_planned_movement_across_tells_when_it_gets_there() -> None:
    memory = _memory()
    assert memory.shifted_by(0.5) == 1.0
    assert memory.shifted_by(-0.5) == np.inf
    assert memory.shifted_by(1.5) == np.inf


def test_a_sampled_command_follows_the_profiles_in_steps_of_a_twentieth_second() -> None:
    command = sampled_command(np.array([1.0]), (0.0, 0.1), np.array([2.0]), np.array([0.0]), 0.6)
    assert command.times == pytest.approx(np.arange(12) * 0.05)
    assert command.acceleration == pytest.approx(2.0 * (command.times + 0.025))
    assert command.steering == pytest.approx(0.1 - 0.1 * (command.times + 0.025))
