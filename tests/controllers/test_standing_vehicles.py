"""The outlines of vehicles that stand, and that a plan into one brakes."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Command, Plan
from controllers.safety.last_check import SHIELDED, LastCheck
from controllers.safety.standing_vehicles import standing_vehicles
from tests.controllers.scenes import FRONT, Car, ego, perception, straight_road

NOBODY = np.zeros(0, dtype=np.bool_)


def _keeps(speed: float) -> Plan:
    horizon = np.linspace(0.2, 5.0, 25)
    still = np.zeros(len(horizon))
    command = Command(np.zeros(1), np.zeros(1), np.zeros(1))
    return Plan(command, times=horizon, along=speed * horizon, across=still, speed=still + speed)


def test_the_outline_is_that_of_the_rectangle() -> None:
    found = standing_vehicles(perception(cars=[Car(10.0, 2.0, length=4.0, width=2.0)]), 3)
    assert found.x.shape == found.y.shape == found.radius.shape
    assert found.x.shape[1] == 3
    assert (found.x.min(), found.x.max()) == pytest.approx((6.0, 10.0))
    assert (found.y.min(), found.y.max()) == pytest.approx((1.0, 3.0))
    assert not found.radius.any()


def test_one_that_stands_across_the_road_is_turned_about_its_middle() -> None:
    across = Car(10.0, 0.0, length=4.0, width=2.0, heading_error=np.pi / 2.0)
    found = standing_vehicles(perception(cars=[across]), 1)
    assert (found.x.min(), found.x.max()) == pytest.approx((9.0, 11.0))
    assert (found.y.min(), found.y.max()) == pytest.approx((-2.0, 2.0))


def test_those_who_drive_or_are_far_do_not_count() -> None:
    seen = perception(cars=[Car(10.0, 0.0, along_speed=1.0), Car(60.0, 0.0)])
    assert len(standing_vehicles(seen, 1).x) == 0


@pytest.mark.parametrize(("across", "status"), [(0.5, SHIELDED), (1.7, SHIELDED), (2.2, "ok")])
def test_a_plan_into_a_vehicle_that_stands_brakes(across: float, status: str) -> None:
    seen = perception(ego(speed=5.0), straight_road(2), cars=[Car(FRONT + 2.0 + 4.5, across)])
    assert LastCheck().checked(seen, _keeps(5.0), NOBODY).status == status
