"""Lanes that end at a vehicle which will not drive on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from controllers.driving.lanes.blocked_lanes import BlockedLanes
from controllers.interface import RoadAhead, Signal, SignalState
from tests.controllers.scenes import Car, ego, lanes_that_follow, perception, straight_road


def _ends(car: Car, seconds: float, road: RoadAhead | None = None, signals: Sequence[Signal] = ()) -> float:
    """Return where the ego's lane is told to end after a vehicle has stood for so long."""
    lanes, road = BlockedLanes(), road or straight_road()
    for tick in range(int(10.0 * seconds) + 1):
        seen = lanes.look(perception(ego(time=0.1 * tick), road, cars=[car], signals=signals))
    here = seen.road.lane(seen.road.reference)
    assert here is not None
    return here.follows_route_for


def test_a_parked_vehicle_ends_its_lane_after_a_while() -> None:
    parked = Car(40.0, 0.0)
    assert math.isinf(_ends(parked, 3.0))
    assert _ends(parked, 5.0) == pytest.approx(40.0 - parked.length - BlockedLanes().distance)


@pytest.mark.parametrize("heading", [math.pi, math.pi / 2.0])
def test_one_that_faces_the_ego_or_stands_across_may_be_waiting_for_it(heading: float) -> None:
    assert math.isinf(_ends(Car(40.0, 0.5, heading_error=heading), 30.0))


@pytest.mark.parametrize(("line", "waits"), [(10.0, True), (37.0, True), (75.0, True), (85.0, False)])
def test_one_in_a_junction_or_queue_at_a_light_is_not_parked(line: float, waits: bool) -> None:
    """Who waits inside the junction to turn left is far beyond the line that the ego has still ahead."""
    ends = _ends(Car(40.0, 0.0), 5.0, signals=[Signal("light", line, SignalState.GREEN)])
    assert math.isinf(ends) == waits


@pytest.mark.parametrize(
    ("follows", "way_past"), [(math.inf, True), (56.0, True), (54.0, False), (45.0, False)]
)
def test_a_lane_beside_that_leads_off_the_route_is_no_way_past(follows: float, way_past: bool) -> None:
    """An ego changed to such a lane from behind a queue, and stood at its end for minutes."""
    road = lanes_that_follow(straight_road(2, 1), {0: follows})
    assert math.isinf(_ends(Car(40.0, 0.0), 5.0, road)) != way_past
