"""A lane change over its time: offsets, arrival, aborts, lanes that vanish."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.driving.lanes.minimum_jerk import minimum_jerk
from controllers.interface import Perception
from controllers.velocity_obstacle.mpc.lane_manoeuvre import LaneManoeuvre
from tests.controllers.scenes import LANE_WIDTH, ego, perception, straight_road

TIMES = np.linspace(0.0, 6.0, 61)


def _in_lane(reference: int, time: float = 0.0, across: float = 0.0, lanes: int = 3) -> Perception:
    return perception(ego(time=time, across=across), straight_road(lanes, reference))


def _begun(target: int = 2) -> LaneManoeuvre:
    manoeuvre = LaneManoeuvre(duration=4.0)
    manoeuvre.settle(_in_lane(1))
    manoeuvre.begin(_in_lane(1), target)
    return manoeuvre


def test_without_a_change_the_middle_of_the_lane_is_wanted() -> None:
    manoeuvre = LaneManoeuvre(4.0)
    manoeuvre.settle(_in_lane(1, across=0.4))
    assert not manoeuvre.running
    assert manoeuvre.target == 1
    assert manoeuvre.offsets(_in_lane(1, across=0.4), TIMES) == pytest.approx(np.zeros(61))


@pytest.mark.parametrize(("target", "offset"), [(2, LANE_WIDTH), (0, -LANE_WIDTH)])
def test_a_change_leads_from_where_the_ego_is_to_the_next_lane_in_its_time(
    target: int, offset: float
) -> None:
    wanted = _begun(target).offsets(_in_lane(1), TIMES)
    assert wanted[0] == pytest.approx(0.0)
    assert wanted[20] == pytest.approx(offset / 2.0)
    assert wanted[40:] == pytest.approx(np.full(21, offset))
    assert (np.diff(np.abs(wanted)) >= -1e-12).all()


def test_the_profile_starts_and_ends_without_speed_and_acceleration() -> None:
    h = 1e-4
    for end in (0.0, 1.0):
        at = minimum_jerk(np.array([end - h, end, end + h]))
        assert abs(at[2] - at[0]) / (2 * h) < 1e-6
        assert abs(at[2] - 2 * at[1] + at[0]) / h**2 < 1e-2


def test_the_wanted_offsets_do_not_jump_when_the_reference_lane_does() -> None:
    manoeuvre = _begun()
    before = manoeuvre.offsets(_in_lane(1, time=2.0), TIMES)
    after = manoeuvre.offsets(_in_lane(2, time=2.0), TIMES)
    assert after + LANE_WIDTH == pytest.approx(before)


def test_a_change_ends_on_arrival_and_not_before_most_of_its_time() -> None:
    manoeuvre = _begun()
    manoeuvre.settle(_in_lane(2, time=1.0, across=0.1))
    assert manoeuvre.running
    manoeuvre.settle(_in_lane(2, time=3.0, across=-0.5))
    assert manoeuvre.running
    manoeuvre.settle(_in_lane(2, time=3.5, across=-0.1))
    assert not manoeuvre.running
    assert manoeuvre.finished == 3.5
    assert manoeuvre.target == 2


def test_an_aborted_change_returns_from_where_the_ego_is() -> None:
    manoeuvre = _begun()
    drifted = _in_lane(1, time=1.0, across=0.6)
    manoeuvre.begin(drifted, 1)
    assert (manoeuvre.target, manoeuvre.origin) == (1, 1)
    wanted = manoeuvre.offsets(drifted, TIMES)
    assert wanted[0] == pytest.approx(0.6)
    assert wanted[-1] == pytest.approx(0.0)


def test_a_lane_that_is_gone_ends_the_change_where_the_ego_is() -> None:
    manoeuvre = _begun()
    narrow = replace(_in_lane(1, time=1.0), road=straight_road(2, 1))
    manoeuvre.settle(narrow)
    assert not manoeuvre.running
    assert manoeuvre.target == 1
    assert manoeuvre.finished == 1.0


def test_an_ego_put_into_another_lane_adopts_it() -> None:
    manoeuvre = LaneManoeuvre(4.0)
    manoeuvre.settle(_in_lane(1))
    manoeuvre.settle(_in_lane(0, time=1.0))
    assert manoeuvre.target == 0
    assert not manoeuvre.running


def test_a_change_whose_ego_stands_in_the_new_lane_is_over_so_that_the_next_may_begin() -> None:
    manoeuvre = _begun()

    def stands(reference: int, time: float) -> Perception:
        return perception(ego(time=time, across=-0.8, speed=0.0), straight_road(3, reference))

    for scene in (stands(1, 9.0), stands(2, 3.0)):  # not in the new lane, or but for a moment
        manoeuvre.settle(scene)
        assert manoeuvre.running
    manoeuvre.settle(stands(2, 9.0))
    assert not manoeuvre.running
    assert manoeuvre.target == 2
