"""A change of lane because of somebody at a crossing: what it gains, and when it is not made."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from controllers.driving.lanes.pedestrian_change import open_for_pedestrians
from controllers.interface import CrossingKind, Perception
from cosim.step.toy_road import Motion, ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld
from tests.controllers.toy_runs import Ride, ride

SPEED = 8.33
ROAD = ToyRoad(lanes=2, lane_width=3.5, speed_limit=SPEED, crossings=(ToyCrossing(90.0),))
FROM_THE_LEFT = walk(92.0, 7.0, 0.0, -0.6, stop=17.5)
"""Out of the left lane when the ego would come, and in the right one for long then."""


def _ride(cost: float, vehicles: Sequence[Motion] = (), kind: CrossingKind = CrossingKind.ZEBRA) -> Ride:
    road = ToyRoad(2, 3.5, SPEED, (ToyCrossing(90.0, kind=kind),))
    given = {"change_cost_near_crossing": cost}
    return ride(road, [FROM_THE_LEFT], vehicles, SPEED, 20.0, 0, given)


def _lane_at_the_crossing(record: Ride) -> float:
    x, y = record.track[:2]
    return float(y[np.argmax(x > 90.0)])


@pytest.mark.long
@pytest.mark.parametrize("kind", [CrossingKind.ZEBRA, CrossingKind.UNMARKED])
def test_it_passes_behind_somebody_in_the_lane_that_they_have_left(kind: CrossingKind) -> None:
    stays, changes = _ride(float("inf"), kind=kind), _ride(1.0, kind=kind)
    assert abs(_lane_at_the_crossing(stays)) < 0.3
    assert stays.track[2].min() < 3.0
    assert abs(_lane_at_the_crossing(changes) - 3.5) < 0.3, "the change has ended before the crossing"
    assert changes.track[2].min() > 7.0
    assert changes.arrival(100.0) < stays.arrival(100.0) - 4.0
    assert changes.clearance() > 1.5


@pytest.mark.long
def test_a_vehicle_before_the_crossing_may_hide_somebody_so_none_is_made() -> None:
    """It has stopped in the lane that would be free."""
    record = _ride(1.0, [walk(88.0, 3.5, 0.0, 0.0)])
    assert np.abs(record.track[1]).max() < 0.3
    assert record.clearance() > 1.0


def _told(world: ToyWorld) -> Perception:
    perceptions = world.sense()
    assert perceptions is not None
    return perceptions[0]


def _open(place: float, vehicles: Sequence[Motion] = (), *, walking: bool = True) -> bool:
    """Return the answer for an ego whose crossing begins that far before its bumper, for the left lane."""
    road = ToyRoad(2, 3.5, SPEED, (ToyCrossing(place + 3.55),))
    y = 5.0 if walking else 30.0
    person = ToyPedestrian("p", walk(place + 5.5, y, 0.0, -0.6))
    cars = [ToyVehicle(f"v{i}", motion) for i, motion in enumerate(vehicles)]
    world = ToyWorld(road, [person], cars, speed=SPEED, duration=1.0, lane=0, step=0.1)
    return open_for_pedestrians(_told(world), 1, 41.65)


def test_the_change_has_to_end_before_the_crossing_and_somebody_has_to_be_there() -> None:
    assert _open(50.0)
    assert not _open(43.0)
    assert not _open(50.0, walking=False)
    beyond = walk(53.55 + 4.0 + 15.0 + 5.0, 3.5, 0.0, 0.0)
    assert _open(50.0, [beyond])
    assert not _open(50.0, [walk(53.55 + 4.0 + 15.0 + 3.0, 3.5, 0.0, 0.0)])
    assert not _open(50.0, [walk(30.0, 0.0, 3.0, 0.0)])
