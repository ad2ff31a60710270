"""The outlines of vehicles near the ego, and that a plan into one that stands brakes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.safety.last_check import SHIELDED, LastCheck
from controllers.safety.vehicle_outlines import DRIVEN_FOR, driving_vehicles, standing_vehicles
from tests.controllers.scenes import FRONT, Car, bend, ego, keeps, perception, straight_road

NOBODY = np.zeros(0, dtype=np.bool_)


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
    assert LastCheck().checked(seen, keeps(5.0), NOBODY).status == status


def test_in_a_bend_the_outline_is_that_of_the_place_in_the_world() -> None:
    """Along the road, the front of a vehicle beside a bend of 6 m is told of another place than its middle."""
    seen = perception(
        ego(speed=3.0),
        bend(straight_road(), 0.0, 6.0, 12.0),
        cars=[Car(9.0, 3.0, length=5.0, heading_error=0.4)],
    )
    placed = replace(seen.vehicles, position=np.array([[6.0, 7.0]]), heading=np.array([np.pi / 2.0]))
    found = standing_vehicles(replace(seen, vehicles=placed), 1)
    assert (found.x.min(), found.x.max()) == pytest.approx((5.1, 6.9))
    assert (found.y.min(), found.y.max()) == pytest.approx((2.0, 7.0))


def test_those_who_drive_are_wherever_they_will_be_but_for_the_ones_behind() -> None:
    crosses = Car(10.0, -6.0, across_speed=2.0, heading_error=np.pi / 2.0)
    follows = Car(-3.0, 0.0, along_speed=4.0)
    x, y = driving_vehicles(perception(ego(speed=0.0), cars=[crosses, follows]))
    assert (x.min(), x.max()) == pytest.approx((9.1, 10.9))
    assert (y.min(), y.max()) == pytest.approx((-6.0 - 2.25, -6.0 + 2.25 + 2.0 * DRIVEN_FOR[-1]))
