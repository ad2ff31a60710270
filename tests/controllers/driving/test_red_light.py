"""A red light that comes late: how the velocity-obstacle controller stops, with the plant that executes it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from controllers import catalog
from controllers.driving.right_of_way import RightOfWay
from controllers.interface import Body, Signal, SignalState
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import FRONT, ego, perception


def _drive(speed: float, distance: float, duration: float = 6.0) -> tuple[float, float]:
    """Return how far beyond the line the front bumper is after so long a red [m], and the speed [m/s]."""
    controller = catalog.build("vo_mpc")
    plant, line = Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, speed), FRONT + distance
    for step in range(round(10.0 * duration)):
        state = ego(plant.speed, time=0.1 * step, acceleration=plant.acceleration, steering=plant.steering)
        seen = perception(state, signals=[Signal("tl", line - plant.x, SignalState.RED)])
        plan = controller.plan(seen, controller.decide(seen))
        plant.follow(plan.command, 0.0, 0.1)
    return plant.front[0] - line, plant.speed


@pytest.mark.parametrize(
    ("speed", "distance"), [(7.28, 7.5), (7.28, 7.0), (7.28, 6.2), (10.0, 9.8), (12.0, 16.0), (13.0, 17.1)]
)
def test_the_ego_stops_before_the_line_where_its_brakes_can_do_that(speed: float, distance: float) -> None:
    # Constant deceleration from here on would be 3.5 to 5.2 m/s²; lag and jerk limit ask for more.
    beyond, left = _drive(speed, distance)
    assert left == 0.0
    assert -1.0 < beyond <= 0.0


def test_it_comes_to_the_line_without_creeping() -> None:
    # 64 m at 12.5 m/s and then 26 m at -3 m/s² would take 9.3 s.
    beyond, _ = _drive(12.5, 90.0, 9.0)
    assert beyond > -3.0
    beyond, speed = _drive(12.5, 90.0, 12.0)
    assert -1.0 < beyond <= 0.0
    assert speed == 0.0


def test_it_does_not_brake_first_and_drive_through_then() -> None:
    beyond, left = _drive(13.0, 14.6)
    assert left == 0.0
    assert beyond < 1.0


def test_it_drives_on_where_braking_would_end_far_in_the_junction() -> None:
    beyond, left = _drive(13.0, 10.5)
    assert beyond > 30.0
    assert left > 12.0


def test_a_stop_that_has_begun_is_given_up_only_where_full_braking_would_not_do() -> None:
    rule, state = RightOfWay(1.8), ego(12.0)  # 12 m with 6 m/s², 9 m with 8 m/s²
    near = perception(state, signals=[Signal("tl", FRONT + 9.0, SignalState.RED)])
    assert rule.stops(near) == []
    far = perception(replace(state, time=0.1), signals=[Signal("tl", FRONT + 13.0, SignalState.RED)])
    assert [stop.name for stop in rule.stops(far)] == ["tl"]
    assert rule.firm_line == FRONT + 13.0
    assert [stop.name for stop in rule.stops(near)] == ["tl"]
    nearer = perception(state, signals=[Signal("tl", FRONT + 7.0, SignalState.RED)])
    assert rule.stops(nearer) == []
    assert rule.stops(near) == []
