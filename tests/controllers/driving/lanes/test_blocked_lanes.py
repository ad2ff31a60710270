"""Lanes that end at a vehicle which will not drive on."""

from __future__ import annotations

import math

import pytest

from controllers.driving.lanes.blocked_lanes import BlockedLanes
from tests.controllers.scenes import Car, ego, perception, straight_road


def _ends(car: Car, seconds: float) -> float:
    """Return where the lane is told to end after a vehicle has stood for so long."""
    lanes = BlockedLanes()
    for tick in range(int(10.0 * seconds) + 1):
        seen = lanes.look(perception(ego(time=0.1 * tick), straight_road(), cars=[car]))
    return seen.road.lanes[0].follows_route_for


def test_a_parked_vehicle_ends_its_lane_after_a_while() -> None:
    parked = Car(40.0, 0.0)
    assert math.isinf(_ends(parked, 3.0))
    assert _ends(parked, 5.0) == pytest.approx(40.0 - parked.length - BlockedLanes().distance)


@pytest.mark.parametrize("heading", [math.pi, math.pi / 2.0])
def test_one_that_faces_the_ego_or_stands_across_may_be_waiting_for_it(heading: float) -> None:
    assert math.isinf(_ends(Car(40.0, 0.5, heading_error=heading), 30.0))
