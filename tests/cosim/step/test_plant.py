"""The plant against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.interface import Body, Command, Drive, constant_command
from cosim.errors import SimulationError
from cosim.step.plant import CAR_DRIVE, Plant, body_of

BODY = Body()
DRIVE = CAR_DRIVE


def plant(speed: float, drive: Drive = DRIVE, heading: float = 0.0) -> Plant:
    return Plant(BODY, drive, 0.0, 0.0, heading, speed)


def state(vehicle: Plant) -> list[float]:
    return [
        vehicle.x,
        vehicle.y,
        vehicle.heading,
        vehicle.speed,
        vehicle.acceleration,
        vehicle.steering,
    ]


def test_a_held_wheel_angle_draws_a_circle_of_radius_wheelbase_over_its_tangent() -> None:
    vehicle = plant(8.0)
    vehicle.steering = 0.2
    radius = BODY.wheelbase / math.tan(0.2)
    for _ in range(200):
        vehicle.follow(constant_command(0.0, 0.2), 0.0, 0.1)
        assert math.hypot(vehicle.x, vehicle.y - radius) == pytest.approx(radius, abs=1e-9)
    assert vehicle.heading == pytest.approx(math.remainder(160.0 / radius, 2 * math.pi), abs=1e-9)


def test_the_acceleration_answers_a_step_as_a_first_order_lag() -> None:
    vehicle = plant(5.0)
    vehicle.follow(constant_command(2.0, 0.0), 0.0, 0.6)
    decay = math.exp(-0.6 / 0.3)
    assert vehicle.acceleration == pytest.approx(2.0 * (1.0 - decay), abs=1e-12)
    assert vehicle.speed == pytest.approx(5.0 + 2.0 * 0.6 - 2.0 * 0.3 * (1.0 - decay), abs=1e-12)
    assert vehicle.x == pytest.approx(3.0 + 0.36 - 0.6 * (0.6 - 0.3 * (1.0 - decay)), abs=1e-12)


def test_the_steering_answers_a_small_step_as_a_first_order_lag() -> None:
    vehicle = plant(0.0)
    vehicle.follow(constant_command(0.0, 0.05), 0.0, 0.2)
    assert vehicle.steering == pytest.approx(0.05 * (1.0 - math.exp(-2.0)), abs=1e-12)


def test_a_large_step_of_the_steering_is_limited_to_its_rate() -> None:
    vehicle = plant(0.0)
    vehicle.follow(constant_command(0.0, 0.6), 0.0, 0.5)
    assert vehicle.steering == pytest.approx(0.3, abs=1e-12)


def test_without_lag_the_stopping_distance_is_speed_squared_over_twice_the_braking() -> None:
    vehicle = plant(13.0, replace(DRIVE, drive_lag=0.0))
    vehicle.follow(constant_command(-5.0, 0.0), 0.0, 4.0)
    assert vehicle.x == pytest.approx(13.0**2 / 10.0, abs=1e-9)
    assert (vehicle.speed, vehicle.acceleration) == (0.0, 0.0)


def test_with_lag_the_stopping_distance_is_longer_by_what_the_lag_costs() -> None:
    vehicle = plant(13.0)
    vehicle.follow(constant_command(-5.0, 0.0), 0.0, 6.0)
    # Once the lag has died out, the speed is 13 + 5·0.3 − 5·t and the way lacks 5·0.3² of its integral.
    assert vehicle.x == pytest.approx((13.0 + 1.5) ** 2 / 10.0 - 5.0 * 0.09, abs=1e-3)
    assert (vehicle.speed, vehicle.acceleration) == (0.0, 0.0)


def test_a_standing_vehicle_does_not_roll_backwards() -> None:
    vehicle = plant(0.0)
    vehicle.follow(constant_command(-8.0, 0.3), 0.0, 3.0)
    assert (vehicle.x, vehicle.y, vehicle.speed, vehicle.acceleration) == (0.0, 0.0, 0.0, 0.0)
    assert vehicle.steering == pytest.approx(0.3, abs=1e-6)


def test_a_vehicle_that_stopped_can_drive_off_again() -> None:
    vehicle = plant(1.0)
    vehicle.follow(constant_command(-8.0, 0.0), 0.0, 2.0)
    stopped_at = vehicle.x
    vehicle.follow(constant_command(1.0, 0.0), 0.0, 3.0)
    assert vehicle.x - stopped_at == pytest.approx(4.5 - 0.3 * (3.0 - 0.3), abs=1e-3)


def test_old_braking_that_stops_the_vehicle_does_not_push_it_back_before_it_drives_off() -> None:
    vehicle = plant(0.02)
    vehicle.acceleration = -1.0
    before = vehicle.x
    for _ in range(30):
        vehicle.follow(constant_command(2.0, 0.0), 0.0, 0.02)
        assert vehicle.x >= before
        before = vehicle.x
    assert vehicle.speed > 0.5


def test_commands_are_cut_to_the_limits_of_the_drive() -> None:
    vehicle = plant(20.0)
    vehicle.follow(constant_command(-50.0, 3.0), 0.0, 2.0)
    assert vehicle.acceleration == pytest.approx(-8.0, abs=0.02)
    assert vehicle.steering == pytest.approx(0.6, abs=1e-3)


def test_a_command_is_piecewise_constant_and_starts_where_the_elapsed_time_says() -> None:
    instant = replace(DRIVE, drive_lag=0.0)
    command = Command(np.array([0.0, 0.5, 1.0]), np.array([1.0, -1.0, 2.0]), np.zeros(3))
    vehicle = plant(10.0, instant)
    vehicle.follow(command, 0.25, 1.0)  # 0.25 s of +1, 0.5 s of −1, 0.25 s of +2
    assert vehicle.speed == pytest.approx(10.25, abs=1e-12)
    vehicle.follow(command, 5.0, 1.0)  # the last entry is held
    assert vehicle.speed == pytest.approx(12.25, abs=1e-12)


@given(
    st.floats(0.0, 20.0), st.floats(-8.0, 2.6), st.floats(-0.6, 0.6), st.integers(2, 60), st.floats(0.1, 2.0)
)
def test_a_second_in_one_call_ends_where_many_short_calls_end(
    speed: float, acceleration: float, steering: float, parts: int, duration: float
) -> None:
    command = constant_command(acceleration, steering)
    once, often = plant(speed), plant(speed)
    once.follow(command, 0.0, duration)
    for part in range(parts):
        often.follow(command, part * duration / parts, duration / parts)
    assert state(once)[3:] == pytest.approx(state(often)[3:], abs=1e-7)
    assert math.hypot(once.x - often.x, once.y - often.y) < 2e-3
    assert abs(math.remainder(once.heading - often.heading, 2 * math.pi)) < 1e-3


def test_the_path_converges_with_short_sub_steps() -> None:
    command = constant_command(1.0, 0.15)
    ends = []
    for parts in (1, 400):
        vehicle = plant(12.0)
        for part in range(parts):
            vehicle.follow(command, part * 2.0 / parts, 2.0 / parts)
        ends.append((vehicle.x, vehicle.y))
    assert math.dist(*ends) < 1e-4


@given(st.floats(0.0, 3.0), st.lists(st.floats(-8.0, 2.6), min_size=1, max_size=20))
def test_the_speed_is_never_negative(speed: float, accelerations: list[float]) -> None:
    vehicle = plant(speed)
    for acceleration in accelerations:
        vehicle.follow(constant_command(acceleration, 0.0), 0.0, 0.13)
        assert vehicle.speed >= 0.0


def test_the_front_bumper_is_ahead_of_the_rear_axle() -> None:
    assert plant(1.0, heading=math.pi / 2).front == pytest.approx((0.0, 4.5 - 0.95))


def test_a_plant_that_adopts_a_state_has_its_bumper_there() -> None:
    vehicle = plant(3.0)
    vehicle.adopt(100.0, 50.0, 1.0, 7.0, -0.5)
    assert vehicle.front == pytest.approx((100.0, 50.0))
    assert state(vehicle)[2:] == [1.0, 7.0, -0.5, 0.0]


def test_a_long_vehicle_has_a_long_wheelbase() -> None:
    bus = body_of(12.0, 2.5)
    assert bus.wheelbase == pytest.approx(2.6 * 12.0 / 4.5)
    assert bus.front + bus.rear_overhang == pytest.approx(12.0)
    assert body_of(4.5, 1.8) == BODY


@pytest.mark.parametrize(
    "command",
    [
        Command(np.zeros(0), np.zeros(0), np.zeros(0)),
        Command(np.zeros(2), np.zeros(1), np.zeros(2)),
        Command(np.zeros(1), np.array([math.nan]), np.zeros(1)),
    ],
)
def test_a_command_without_values_is_refused(command: Command) -> None:
    with pytest.raises(SimulationError, match="a command"):
        plant(1.0).follow(command, 0.0, 0.1)


def test_a_body_without_length_is_refused() -> None:
    with pytest.raises(SimulationError, match="length"):
        body_of(0.0, 1.8)


def test_a_wheel_that_turns_evenly_draws_a_clothoid() -> None:
    """Over 0.5 m the curvature grows evenly from 0: sideways a sixth of curvature times distance squared."""
    vehicle = plant(10.0, replace(DRIVE, steering_lag=0.0))
    vehicle.follow(constant_command(0.0, 0.6), 0.0, 0.05)
    curvature = math.tan(0.6 * 0.05) / BODY.wheelbase
    assert vehicle.steering == pytest.approx(0.03)
    assert vehicle.heading == pytest.approx(curvature * 0.5 / 2, rel=1e-3)
    assert vehicle.y == pytest.approx(curvature * 0.5**2 / 6, rel=1e-3)


def test_a_call_no_longer_than_a_substep_is_one_of_them() -> None:
    """Over 0.5 m the wheel turns from 0 to 0.5 rad: Simpson's rule with its three angles."""
    vehicle = plant(10.0, replace(DRIVE, steering_lag=0.0, max_steering_rate=10.0))
    vehicle.follow(constant_command(0.0, 0.6), 0.0, 0.05)
    mean = (4.0 * math.tan(0.25) + math.tan(0.5)) / 6.0 / BODY.wheelbase
    assert vehicle.heading == pytest.approx(0.5 * mean, rel=1e-12)
