"""Lanes of two networks that belong together, with numbers that can be checked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from cosim.inspection.lane_shift import LaneShift
from cosim.sumo.network import NetLane, Network, Permissions

ALL = Permissions()
WALK = Permissions(allow=frozenset({"pedestrian"}))
DRIVE = Permissions(disallow=frozenset({"pedestrian"}))
BUS = Permissions(allow=frozenset({"bus"}))


def network(*lanes: tuple[float, float, float, Permissions], length: float | None = None) -> Network:
    """Return a network of one edge to the east; each lane has an offset to the left, begin, end and users."""
    made = [
        NetLane(f"e_{i}", "e", i, length or end - begin, 3.2, 13.9, np.array([[begin, y], [end, y]]), who)
        for i, (y, begin, end, who) in enumerate(lanes)
    ]
    return Network({lane.name: lane for lane in made}, {"e": tuple(lane.name for lane in made)}, {}, {}, {})


def test_a_new_sidewalk_moves_lanes_up() -> None:
    before = network((-4.8, 0, 100, ALL), (-1.6, 0, 100, ALL))
    after = network((-7.4, 0, 100, WALK), (-4.8, 0, 100, DRIVE), (-1.6, 0, 100, DRIVE))
    shift = LaneShift(before, after)
    assert [shift.lane("e_0"), shift.lane("e_1"), shift.lane("e_2")] == ["e_1", "e_2", None]
    assert shift.index("e", 1) == 2
    assert shift.index("e", 2) is None
    assert shift.lane_on_foot("e_1") == "e_0"


def test_users_tell_lanes_apart_where_the_road_was_moved_aside() -> None:
    # A road drawn around its middle: a sidewalk of 2 m moves its lanes by 1 m.
    before = network((-1.6, 0, 100, BUS), (1.6, 0, 100, ALL))
    after = network((-3.6, 0, 100, WALK), (-0.6, 0, 100, BUS), (2.6, 0, 100, DRIVE))
    shift = LaneShift(before, after)
    assert [shift.lane("e_0"), shift.lane("e_1")] == ["e_1", "e_2"]


def test_a_place_is_where_it_was_and_not_beyond_the_end() -> None:
    before = network((0, 0, 100, ALL))
    after = network((-2.6, 5, 90, WALK), (0, 5, 90, DRIVE))
    shift = LaneShift(before, after)
    assert shift.place("e_0", "e_1", 50.0) == pytest.approx(45.0)
    assert shift.place("e_0", "e_1", 3.0) == 0.0
    assert shift.place("e_0", "e_1", 95.0) == 85.0
    assert shift.place("e_0", "e_1", -10.0) == -10.0
    assert shift.place("e_0", "e_1", -95.0) == -85.0
    assert shift.place_on_edge("e", 50.0) == pytest.approx(45.0)


def test_a_lane_may_be_longer_than_it_is_drawn() -> None:
    before = network((0, 0, 100, ALL), length=200.0)
    after = network((-2.6, 0, 50, WALK), (0, 0, 50, DRIVE))
    assert LaneShift(before, after).place("e_0", "e_1", 60.0) == pytest.approx(30.0)


def test_lanes_that_are_elsewhere_are_not_taken_for_each_other() -> None:
    before = network((0, 0, 100, ALL))
    assert LaneShift(before, network((30, 0, 100, DRIVE))).lane("e_0") is None
    assert LaneShift(network((0, 0, 100, ALL), (3, 0, 100, ALL)), before).lane("e_0") is None
