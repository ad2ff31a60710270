"""Lanes that end at a vehicle which will not drive on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from controllers.driving.lanes.blocked_lanes import BlockedLanes
from controllers.interface import RoadAhead, Signal, SignalState
from tests.controllers.scenes import Car, ego, lanes_that_follow, perception, straight_road


def _ends(
    car: Car | Sequence[Car],
    seconds: float,
    road: RoadAhead | None = None,
    signals: Sequence[Signal] = (),
) -> float:
    """Return where the ego's lane is told to end after one vehicle, or several, have stood for so long."""
    cars = [car] if isinstance(car, Car) else car
    lanes, road = BlockedLanes(), road or straight_road()
    for tick in range(int(10.0 * seconds) + 1):
        seen = lanes.look(perception(ego(time=0.1 * tick), road, cars=cars, signals=signals))
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


def _queue(head: float, cars: int, gap: float = 2.5) -> list[Car]:
    """Return vehicles one behind the other; the first one's front is at ``head``."""
    return [Car(head - one * (Car(0.0, 0.0).length + gap), 0.0) for one in range(cars)]


@pytest.mark.parametrize(("gap", "parked"), [(2.5, False), (9.0, False), (11.0, True)])
def test_the_tail_of_a_queue_at_a_light_is_not_parked_however_long_the_queue(
    gap: float, parked: bool
) -> None:
    """An ego overtook such a queue in a lane that led off its route, and stood at its end for minutes."""
    at_the_line = [Signal("light", 110.0, SignalState.RED)]
    cars = _queue(108.0, 7, gap)
    assert cars[-1].along < 110.0 - BlockedLanes().reason
    assert math.isfinite(_ends(cars, 30.0, signals=at_the_line)) == parked
    assert math.isfinite(_ends(cars[-1], 30.0, signals=at_the_line))


def test_a_queue_behind_a_parked_vehicle_is_not_moving_on_either() -> None:
    cars = _queue(80.0, 4)
    nearest = cars[-1]
    assert _ends(cars, 5.0) == pytest.approx(nearest.along - nearest.length - BlockedLanes().distance)


def test_patience_counts_from_when_a_vehicle_stands_for_no_reason() -> None:
    """The vehicles ahead of it drive on, and it does not."""
    lanes, road = BlockedLanes(), straight_road()
    light = [Signal("light", 110.0, SignalState.RED)]
    ends = []
    for tick in range(250):
        cars = _queue(108.0, 7)[0 if tick < 200 else 6 :]
        seen = lanes.look(perception(ego(time=0.1 * tick), road, cars=cars, signals=light))
        here = seen.road.lane(seen.road.reference)
        assert here is not None
        ends.append(here.follows_route_for)
    first = next(tick for tick, end in enumerate(ends) if math.isfinite(end))
    assert first == pytest.approx(200 + 10 * lanes.patience, abs=1)
