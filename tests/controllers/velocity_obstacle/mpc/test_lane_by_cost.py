"""Where an ego waits for a change of lane that its route asks for."""

from __future__ import annotations

import math

import pytest

from controllers import catalog
from controllers.interface import Body
from controllers.velocity_obstacle.mpc.driver import VelocityObstacleMpc
from controllers.velocity_obstacle.mpc.lane_by_cost import LaneByCost
from tests.controllers.scenes import ego, lanes_that_follow, perception, straight_road

ENDS = 60.0


def _place(reference: int, speed: float = 5.0, ends: float = ENDS) -> float:
    driver = catalog.build("vo_mpc", seed=1)
    assert isinstance(driver, VelocityObstacleMpc)
    settings = driver.settings.change
    road = lanes_that_follow(straight_road(2, reference), {reference: ends})
    return LaneByCost(settings, driver._lanes).waiting_place(perception(ego(speed=speed), road))


def test_of_two_side_by_side_who_want_each_others_lane_the_left_one_waits_behind_the_other() -> None:
    to_the_left, to_the_right = _place(0), _place(1)
    assert to_the_left < ENDS
    assert to_the_left - to_the_right > Body().length + 2.5


def test_who_cannot_stop_there_waits_nearer_to_the_end_or_nowhere() -> None:
    assert _place(1, speed=15.0, ends=45.0) == pytest.approx(_place(0, ends=45.0))
    assert math.isinf(_place(1, speed=25.0))
