"""The search for a way round those who stay: where it leads, and where it does not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.geometry.box_clearances import Boxes, box_clearances
from controllers.geometry.boxes_of_vehicles import NONE
from controllers.geometry.path_clearance import disc_clearances
from controllers.interface import Body
from controllers.safety import free_way
from controllers.safety.free_way import ARC, DRIFT, REACH, SHORTEST, Obstacles
from controllers.safety.way_out import LEAST_TO_VEHICLES, NEARER, TO_VEHICLES
from tests.controllers.scenes import bend, ego, perception, straight_road

BODY = Body()
KEPT = 0.3
"""Radius of a person and distance kept from them [m]."""


def _people(*places: tuple[float, float]) -> Obstacles:
    x, y = np.array(places, dtype=float).reshape(-1, 2).T
    return Obstacles(x, y, np.full(len(x), KEPT), NONE, np.zeros(0), np.zeros(0))


def _driven(
    way: FloatArray, across: float = 0.0, heading: float = 0.0, arc: float = ARC
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle after each arc, shape (k, 1) each."""
    turned = arc * np.tan(way) / BODY.wheelbase
    headings = heading + np.cumsum(turned)
    middle = headings - 0.5 * turned
    x, y = np.cumsum(arc * np.cos(middle)), across + np.cumsum(arc * np.sin(middle))
    return x[:, None], y[:, None], headings[:, None]


def _nearest(way: FloatArray, people: Obstacles) -> float:
    return _nearest_of(_driven(way), people)


def _nearest_of(poses: tuple[FloatArray, FloatArray, FloatArray], people: Obstacles) -> float:
    x, y, heading = poses
    still = (np.repeat(values[:, None], len(x), axis=1) for values in (people.x, people.y, people.kept))
    return float(disc_clearances(x, y, heading, BODY, *still).min())


def test_with_nobody_in_the_way_it_is_straight_and_as_long_as_looked_for() -> None:
    way = free_way.find(perception(ego(speed=0.0)), _people(), np.inf)
    assert way is not None
    assert len(way) * ARC == pytest.approx(REACH)
    assert np.abs(way).max() == pytest.approx(0.0, abs=1e-9)


def test_from_beside_the_lane_it_leads_back() -> None:
    way = free_way.find(perception(ego(speed=0.0, across=1.0)), _people(), np.inf)
    assert way is not None
    assert abs(_driven(way, 1.0)[1][-1, 0]) < 0.3


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_goes_round_somebody_at_a_corner_and_comes_back(side: float) -> None:
    corner = _people((BODY.front + 0.9, side * 1.05))
    way = free_way.find(perception(ego(speed=0.0)), corner, np.inf)
    assert way is not None
    assert way[0] * side < 0.0
    assert _nearest(way, corner) >= 0.0
    assert abs(_driven(way)[1][-1, 0]) < 0.5


def test_a_way_does_not_lead_over_somebody_whose_centre_is_under_the_side_already() -> None:
    """The lane bends to the left, where they stand: turning with it at once would bring them farther in."""
    seen = perception(ego(speed=0.0, heading_error=-0.15), bend(straight_road(), 0.0, 8.0, 30.0))
    at, start = (1.74, 0.5 * BODY.width - 0.02), -0.15
    east = math.cos(start) * at[0] - math.sin(start) * at[1]
    north = math.sin(start) * at[0] + math.cos(start) * at[1]
    leans, place = _people((east, north)), np.zeros((1, 1))
    now = _nearest_of((place, place, place + start), leans)
    way = free_way.find(seen, leans._replace(kept=leans.kept + now), np.inf)
    assert way is not None
    x, y, heading = (values[:, 0] for values in _driven(way, heading=start))
    ahead = np.cos(heading) * (leans.x - x) + np.sin(heading) * (leans.y - y)
    beside = np.cos(heading) * (leans.y - y) - np.sin(heading) * (leans.x - x)
    assert beside[ahead > -BODY.rear_overhang].min() >= at[1]


@pytest.mark.parametrize("beside", [0.0, 0.04, 0.08, 0.12])
@pytest.mark.parametrize("ahead", [0.15, 0.2, 0.25, 0.3])
def test_between_two_poses_a_corner_comes_no_nearer_than_a_driven_way_may(
    ahead: float, beside: float
) -> None:
    """The corner passes whoever stands there within the first half metre to the left."""
    place = BODY.front + ahead, -0.5 * BODY.width - beside
    kept = math.hypot(ahead, beside) - NEARER
    at_the_corner = _people(place)._replace(kept=np.array([kept]))
    way = free_way.find(perception(ego(speed=0.0)), at_the_corner, np.inf)
    if way is not None:
        finely = np.repeat(way, 20)
        assert _nearest_of(_driven(finely, arc=ARC / 20), at_the_corner) >= -DRIFT


def test_it_goes_between_two_with_little_room_and_nowhere_without_any() -> None:
    apart = 0.5 * BODY.width + KEPT
    gate = _people((6.0, -apart - 0.05), (7.0, apart + 0.05))
    way = free_way.find(perception(ego(speed=0.0, across=0.3)), gate, np.inf)
    assert way is not None
    closed = _people((6.0, -apart + 0.2), (6.0, apart - 0.2))
    assert free_way.find(perception(ego(speed=0.0)), closed, np.inf) is None


@pytest.mark.long
def test_no_corner_of_a_vehicle_is_overlooked() -> None:
    """Boxes set askew in the way: the distance to each is kept exactly, between the corners too."""
    for turned in np.linspace(0.0, np.pi, 9):
        one = Boxes(*(np.array([value]) for value in (7.0, 2.2, turned, 4.5, 1.8)))
        vehicle = _people()._replace(boxes=one, kept_to_boxes=np.full(1, 0.1), until=np.full(1, np.inf))
        way = free_way.find(perception(ego(speed=0.0)), vehicle, np.inf)
        assert way is not None
        assert box_clearances(*_driven(way), BODY, one).min() >= 0.1


def test_leaving_out_what_is_too_far_away_changes_no_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Vehicles of many sizes stand at random ahead of the ego."""
    random = np.random.default_rng(7)
    seen, scenes = perception(ego(speed=0.0)), []
    for _ in range(12):
        length, width = random.uniform(2.0, 16.0, 3), random.uniform(1.0, 3.0, 3)
        x, y = random.uniform(4.0, 20.0, 3), random.choice([-1.0, 1.0], 3) * random.uniform(1.5, 5.0, 3)
        boxes = Boxes(x, y, random.uniform(-0.6, 0.6, 3), length, width)
        scenes.append(
            _people()._replace(boxes=boxes, kept_to_boxes=np.full(3, TO_VEHICLES), until=np.full(3, np.inf))
        )
    ways = [free_way.find(seen, scene, 8.0) for scene in scenes]
    monkeypatch.setattr(free_way, "_close", lambda _, x, *__: np.ones((len(x), 3), bool))
    again = [free_way.find(seen, scene, 8.0) for scene in scenes]
    assert [None if way is None else way.tolist() for way in ways] == [
        None if way is None else way.tolist() for way in again
    ]
    assert sum(way is not None and np.abs(way).max() > 0.1 for way in ways) >= 3


@pytest.mark.parametrize(("until", "found"), [(0.0, True), (2.0, True), (5.0, False), (np.inf, False)])
def test_a_vehicle_counts_for_only_as_far_as_the_ego_gets_while_it_is_there(
    until: float, found: bool
) -> None:
    """It is across both lanes, 4 m ahead of the front bumper."""
    across = Boxes(*(np.array([value]) for value in (BODY.front + 4.0, 0.0, 0.5 * np.pi, 12.0, 1.8)))
    vehicle = _people()._replace(boxes=across, kept_to_boxes=np.full(1, 0.1), until=np.full(1, until))
    seen = perception(ego(speed=0.0), straight_road(2))
    way = free_way.find(seen, vehicle, np.inf)
    assert (way is not None) == found
    straight = np.zeros(int(REACH / ARC))
    assert free_way.leads_on(seen, vehicle, straight, 0.0) == found
    assert free_way.leads_on(seen, vehicle, straight, REACH - 2.0)


def test_it_goes_no_farther_than_it_may_and_not_at_all_for_a_few_steps() -> None:
    seen = perception(ego(speed=0.0))
    way = free_way.find(seen, _people(), 8.0)
    assert way is not None
    assert len(way) * ARC == pytest.approx(8.0)
    assert free_way.find(seen, _people(), SHORTEST - 0.5) is None


def test_in_a_tight_bend_it_passes_people_who_stand_inside_by_turning_late() -> None:
    """A car cuts the corner with its inner rear wheel, on which people stand who wait there."""
    road = bend(straight_road(), 1.0, 6.0, 9.0)
    inside = _people((2.6, 1.22), (3.2, 1.3))
    way = free_way.find(perception(ego(speed=0.0), road), inside, np.inf)
    assert way is not None
    assert _nearest(way, inside) >= 0.0
    assert way[0] < way.max()


ROW = [(8.0, float(y)) for y in np.arange(-1.6, 1.7, 0.8)]
"""People across the lane and to either side of it, who can only be gone round beside the road."""


def test_beyond_the_lane_it_leads_only_where_it_may() -> None:
    seen, row = perception(ego(speed=0.0)), _people(*ROW)
    assert free_way.find(seen, row, np.inf) is None
    way = free_way.find(seen, row, np.inf, beyond=1.5)
    assert way is not None
    assert _nearest(way, row) >= 0.0


def test_off_those_who_lean_on_the_car_a_short_way_will_do_and_one_that_stays_beside_them_will_not() -> None:
    """A wall 4 m ahead of the bumper leaves no way as long as is asked for otherwise."""
    seen, wall = perception(ego(speed=0.0)), [(BODY.front + 4.0, y) for y in np.arange(-3.0, 3.1, 0.5)]
    leans = (0.5, -0.5 * BODY.width + 0.02 - KEPT)
    assert free_way.find(seen, _people(*wall), np.inf) is None
    way = free_way.find(seen, _people(*wall), np.inf, off=_people(leans))
    assert way is not None
    assert 2.0 <= len(way) * ARC <= 4.0
    x, y, heading = _driven(way)
    assert _nearest_of((x[-1:], y[-1:], heading[-1:]), _people(leans)) >= 0.0
    rows = _people(*((x, side * 0.5 * BODY.width) for x in np.arange(-1.0, 8.0, 0.5) for side in (-1.0, 1.0)))
    assert free_way.find(seen, _people(*wall), np.inf, off=rows) is None


def test_a_way_that_somebody_has_stepped_into_does_not_lead_on() -> None:
    seen, free = perception(ego(speed=0.0)), _people()
    way = free_way.find(seen, free, np.inf)
    assert way is not None
    assert free_way.leads_on(seen, free, way, 1.2)
    assert not free_way.leads_on(seen, _people((7.0, 0.5)), way, 1.2)


@pytest.mark.parametrize("gap", [0.01, 0.04, 0.2])
def test_on_the_way_the_ego_does_not_drift_into_a_vehicle_beside_it(gap: float) -> None:
    """Each search measures the distance anew, so without a bound the drifts added up to contact."""
    kept = np.array([min(gap, TO_VEHICLES)])
    for _ in range(20):
        kept = np.minimum(kept, free_way.drifted(kept, LEAST_TO_VEHICLES))
    assert kept[0] == pytest.approx(min(gap, LEAST_TO_VEHICLES))
