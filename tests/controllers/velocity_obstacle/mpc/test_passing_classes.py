"""What passing behind or ahead of pedestrians asks of the position."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.velocity_obstacle.mpc.arithmetic.passing_bounds import shortfalls
from controllers.velocity_obstacle.mpc.passing_classes import class_name, stops
from tests.controllers.conflicts.found import REACH, REAR, TIMES, found_among, on_zebra, position_bounds
from tests.controllers.scenes import FRONT, Walker, perception, straight_road, zebra


def test_a_class_is_named_after_who_is_let_pass() -> None:
    found = found_among([Walker(30.0, -3.0, 0.0, 1.3), Walker(40.0, -4.0, 0.0, 1.3)])
    assert class_name(found, 0) == "behind= ahead=person0|person1"
    assert class_name(found, 1) == "behind=person0 ahead=person1"
    assert class_name(found_among([]), 0) == ""


def test_passing_behind_bounds_the_front_until_the_pedestrian_has_left() -> None:
    # Enters at 1 s, leaves at 1 + 3.5 / 1.4 = 3.5 s.
    found = found_among([Walker(30.0, -REACH - 1.4, 0.0, 1.4)])
    assert found.enter[0] == pytest.approx(1.0)
    assert found.leave[0] == pytest.approx(3.5)
    upper, lower, freeze = position_bounds(found, 1, TIMES, FRONT, REAR, 1.0, np.full(len(TIMES), 10.0))
    limit = 30.0 - 0.25 - 1.0 - FRONT
    # Before the entry as well: the ego must not have passed when the pedestrian comes.
    assert np.allclose(upper[TIMES <= 3.5], limit)
    assert np.isinf(upper[TIMES > 4.0]).all()
    assert np.isinf(-lower).all()
    # Only while the pedestrian is expected in the band, from the last grid time before the entry.
    assert np.allclose(freeze[(TIMES >= 1.0) & (TIMES <= 3.5)], limit - 0.25)
    assert np.isinf(freeze[TIMES < 1.0 - 1e-9][:1]).all()


def test_a_bound_that_ends_between_two_times_moves_on_with_the_expected_speed() -> None:
    found = found_among([Walker(30.0, -REACH - 1.4, 0.0, 1.4)])
    times = np.array([1.0, 3.0, 4.0])
    upper, *_ = position_bounds(found, 1, times, FRONT, REAR, 1.0, np.full(3, 8.0))
    limit = 30.0 - 1.25 - FRONT
    assert upper == pytest.approx([limit, limit, limit + 8.0 * 0.5])


def test_passing_ahead_asks_to_have_passed_when_the_pedestrian_enters() -> None:
    found = found_among([Walker(30.0, -REACH - 1.4 * 2.2, 0.0, 1.4)])
    upper, lower, freeze = position_bounds(found, 0, TIMES, FRONT, REAR, 1.0, np.full(len(TIMES), 10.0))
    past = 30.0 + 0.25 + 1.0 + REAR
    assert np.isinf(-lower[TIMES < 2.2]).all()
    # 2.5 s is the first grid time after entry: the bound is carried on at the expected speed.
    assert lower[TIMES == 2.5] == pytest.approx(past + 10.0 * 0.3)
    assert np.allclose(lower[(TIMES >= 3.0) & (TIMES <= 2.2 + 2.5)], past)
    assert np.isinf(upper).all()
    assert np.isinf(freeze).all()


def test_of_several_pedestrians_the_tightest_bound_counts() -> None:
    found = found_among(
        [Walker(30.0, 0.0, 0.0, 1.0), Walker(20.0, -3.0, 0.0, 1.0), Walker(40.0, -5.0, 0.0, 1.0)]
    )
    assert found.names == ("person0", "person1", "person2")
    upper, lower, _ = position_bounds(found, 2, TIMES, FRONT, REAR, 1.0, np.full(len(TIMES), 10.0))
    assert upper.min() == pytest.approx(20.0 - 1.25 - FRONT)
    assert lower.max() >= 40.0 + 1.25 + REAR


def test_who_yields_stops_at_the_stop_line_unless_the_bumper_is_past_it() -> None:
    walker = Walker(30.0, -2.0, 0.0, 1.3, 0, True)
    before = found_among([], on_zebra([walker]))
    assert before.stop_line[0] == 27.0
    speed = np.full(len(TIMES), 5.0)
    upper, *_ = position_bounds(before, 1, TIMES, FRONT, REAR, 1.0, speed)
    assert upper.min() == pytest.approx(27.0 - FRONT)
    near = perception(road=straight_road(3, 1), walkers=[replace(walker, along=6.0)], crossings=[zebra(4.0)])
    past = found_among([], near)
    assert past.stop_line[0] == 3.0
    upper, *_ = position_bounds(past, 1, TIMES, FRONT, REAR, 1.0, speed)
    assert upper.min() == pytest.approx(6.0 - 1.25 - FRONT)


def test_a_pedestrian_who_walks_along_the_road_moves_the_bound_for_three_seconds() -> None:
    found = found_among([Walker(30.0, 0.0, -1.0, 0.3)])
    upper, *_ = position_bounds(found, 1, TIMES, FRONT, REAR, 1.0, np.zeros(len(TIMES)))
    active = np.isfinite(upper)
    wanted = 30.0 - np.minimum(TIMES, 3.0) - 1.25 - FRONT
    assert np.allclose(upper[active], wanted[active])


def test_who_is_let_pass_sets_no_bound_for_passing_the_others_ahead() -> None:
    """Whoever enters first is farthest away; a speed of 0 carries no bound on."""
    found = found_among(
        [Walker(60.0, -2.0, 0.0, 1.0), Walker(20.0, -3.0, 0.0, 1.0), Walker(40.0, -4.0, 0.0, 1.0)]
    )
    largest = [
        position_bounds(found, behind, TIMES, FRONT, REAR, 1.0, np.zeros(len(TIMES)))[1].max()
        for behind in range(4)
    ]
    past = 0.25 + 1.0 + REAR
    assert largest == pytest.approx([60.0 + past, 40.0 + past, 40.0 + past, -np.inf])


def test_who_is_let_pass_is_stopped_for_at_the_line_or_before_them_once_it_is_past() -> None:
    """The stop line is at 27 m; the disc and the margin are 1.25 m. The overlap ends at 1.75 m."""
    found = found_among([], on_zebra([Walker(30.0, -2.0, 0.0, 1.25, 0, True)]))
    at, line, until = stops(found, 1, FRONT, 1.0)
    assert (at.tolist(), line.tolist(), until.tolist()) == ([30.0], [27.0], [pytest.approx(3.0)])
    assert stops(found, 1, 27.2, 1.0)[1].tolist() == [27.2]
    assert stops(found, 1, 27.4, 1.0)[1].tolist() == [28.75]
    assert [len(part) for part in stops(found, 0, FRONT, 1.0)] == [0, 0, 0]


@pytest.mark.parametrize(
    ("largest", "late"),
    [(np.inf, 1.0), (10.5, 1.5)],
)
def test_a_class_falls_short_by_what_driving_on_and_braking_cannot_reach(largest: float, late: float) -> None:
    """From 10 m/s to 12 m/s at 2 m/s²: 11 m in 1 s, 35 m in 3 s. Braking with 4 m/s²: 8 m, 12.5 m."""
    free = np.inf
    lower = np.array([[12.0, 30.0], [-free, -free], [11.5, 36.0], [8.0, 20.0]])
    upper = np.array([[free, free], [free, 12.0], [7.5, free], [11.0, 35.0]])
    found = shortfalls(
        lower, upper, np.array([largest, free]), np.array([1.0, 3.0]), 10.0, np.array([9.0, 12.0]), 2.0, 4.0
    )
    # Too late, too soon, both, and reachable.
    assert found == pytest.approx([late + 0.0, 0.5, 1.0 + 0.5, 0.0])
