"""What limits, bends and crossings to be kept clear ask of the speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.driving.keep_clear import keep_clear_line, keep_clear_of_people
from controllers.driving.road_speeds import reference_speed
from controllers.interface import CrossingKind, Perception
from tests.controllers.scenes import FRONT, Walker, bend, ego, perception, straight_road, zebra

POSITIONS = np.array([0.0, 10.0, 20.0, 30.0, 40.0, 60.0])
TIMES = np.arange(0.5, 6.1, 0.5)


def _reference(scene: Perception) -> list[float]:
    return [float(speed) for speed in reference_speed(scene, POSITIONS, 2.0, 1.5)]


def test_on_a_straight_road_the_limit_is_wanted_everywhere() -> None:
    assert _reference(perception(road=straight_road(limit=13.89))) == pytest.approx([13.89] * 6)


def test_a_lower_limit_ahead_is_met_in_time_and_kept() -> None:
    road = replace(
        straight_road(limit=13.89), limit_along=np.array([-5.0, 30.0]), limit=np.array([13.89, 8.0])
    )
    expected = [min(13.89, np.sqrt(64.0 + 3.0 * (30.0 - p))) for p in (0.0, 10.0, 20.0)] + [8.0] * 3
    assert _reference(perception(road=road)) == pytest.approx(expected)


def test_a_higher_limit_ahead_is_used_only_from_where_it_holds() -> None:
    road = replace(straight_road(), limit_along=np.array([-5.0, 25.0]), limit=np.array([8.0, 13.89]))
    assert _reference(perception(road=road)) == pytest.approx([8.0] * 3 + [13.89] * 3)


def test_a_bend_is_taken_at_the_comfortable_lateral_acceleration_and_then_left_behind() -> None:
    road = bend(straight_road(limit=20.0), begins=25.0, radius=18.0, length=10.0)
    speeds = _reference(perception(road=road))
    assert speeds[3] == pytest.approx(np.sqrt(2.0 * 18.0))
    assert speeds[2] == pytest.approx(np.sqrt(36.0 + 3.0 * 5.0))
    # Its end lies between the instants 3 and 4: the way to 4 leads through it.
    assert speeds[4] == pytest.approx(6.0)
    assert speeds[5] == pytest.approx(20.0)


def test_a_road_that_is_not_seen_asks_only_for_its_limit() -> None:
    road = replace(straight_road(limit=9.0), curvature=np.zeros(0))
    assert _reference(perception(road=road)) == pytest.approx([9.0] * 6)


def _line(scene: Perception, rest: float) -> tuple[float, str]:
    return keep_clear_line(scene, TIMES, np.full(len(TIMES), rest), 2.5)


def test_a_crossing_is_kept_clear_when_there_is_no_room_behind_it() -> None:
    scene = perception(ego(speed=8.0), crossings=[zebra(30.0)])
    # Exit at 34 m, a car of 4.5 m, half a metre, and 2.5 m to the vehicle ahead.
    assert _line(scene, 34.0 + 4.5 + 0.5 + 2.5 + 0.01) == (np.inf, "")
    assert _line(scene, 34.0 + 4.5 + 0.5 + 2.5 - 0.01) == (29.0, "zebra")


@pytest.mark.parametrize(("speed", "kept"), [(11.0, True), (13.5, True), (15.5, False)])
def test_a_stop_before_a_crossing_is_not_given_up_because_the_plan_braked_gently_at_first(
    speed: float, kept: bool
) -> None:
    """From 11 m/s, 2.2 m/s^2 is enough to stop at the line; from 13.5 m/s, it takes 3.3 m/s^2."""
    scene = perception(ego(speed=speed), crossings=[zebra(32.0)])
    rest = np.full(len(TIMES), 38.0)
    begun = keep_clear_line(scene, TIMES, rest, 2.5, {"zebra"})
    assert begun == ((31.0, "zebra") if kept else (np.inf, ""))
    fresh = keep_clear_line(scene, TIMES, rest, 2.5, {"another"})
    assert fresh == ((31.0, "zebra") if speed == 11.0 else (np.inf, ""))


def test_nobody_ahead_means_room() -> None:
    assert _line(perception(ego(speed=8.0), crossings=[zebra(30.0)]), np.inf) == (np.inf, "")


def test_what_counts_is_where_the_leader_could_stop_when_the_ego_arrives() -> None:
    scene = perception(ego(speed=8.0), crossings=[zebra(30.0)])
    arrival = (29.0 - FRONT) / 8.0
    leaving = np.where(arrival - 0.5 > TIMES, 36.0, 60.0)
    assert keep_clear_line(scene, TIMES, leaving, 2.5) == (np.inf, "")
    assert keep_clear_line(scene, TIMES, 96.0 - leaving, 2.5) == (29.0, "zebra")


def test_an_ego_past_the_stop_line_stops_before_the_crossing_itself() -> None:
    """It rolled onto the crossing, 1 m behind the line, up to whoever stood beyond."""
    ahead = zebra(FRONT + 0.6)
    for speed, line in ((0.0, ahead.entry), (0.8, ahead.entry), (3.0, np.inf)):
        scene = perception(ego(speed=speed), crossings=[replace(ahead, stop_line=FRONT - 0.7)])
        assert _line(scene, FRONT + 6.0)[0] == line


def test_a_crossing_the_ego_is_on_or_cannot_stop_before_is_not_stopped_at() -> None:
    assert _line(perception(ego(speed=8.0), crossings=[zebra(2.0)]), 10.0) == (np.inf, "")
    assert _line(perception(ego(speed=14.0), crossings=[zebra(20.0)]), 25.0) == (np.inf, "")
    assert _line(perception(ego(speed=8.0), crossings=[zebra(20.0)]), 25.0) == (19.0, "zebra")


@pytest.mark.parametrize(
    ("along", "place", "until", "line"),
    [
        (38.0, 37.0, 60.0, 29.0),
        (38.0, 37.0, np.inf, 29.0),
        # Gone by the time the ego has left the crossing, and a second later.
        (38.0, 37.0, 4.0, np.inf),
        # On the crossing itself, and so far behind it that a car has room between.
        (33.0, 29.0, 60.0, np.inf),
        (42.0, 39.5, 60.0, np.inf),
    ],
)
def test_a_crossing_is_kept_clear_of_people_behind_it(
    along: float, place: float, until: float, line: float
) -> None:
    scene = perception(ego(speed=8.0), crossings=[zebra(30.0)], walkers=[Walker(along, 0.0)])
    found = keep_clear_of_people(
        scene, np.array([0]), np.array([along]), np.array([place]), np.array([until])
    )
    assert found == line
    none = np.zeros(0)
    assert keep_clear_of_people(scene, none.astype(int), none, none, none) == np.inf


@pytest.mark.parametrize(
    ("walker", "green", "line"),
    [
        # They wait for another crossing, which the ego does not come to, or for their light.
        (Walker(33.0, -1.2, waiting=True), None, 29.0),
        (Walker(33.0, -1.2, crossing=0, waiting=True), False, 29.0),
        # They wait for the ego to leave, or walk on.
        (Walker(33.0, -1.2, crossing=0, waiting=True), None, np.inf),
        (Walker(33.0, -1.2, crossing=0, waiting=True), True, np.inf),
        (Walker(33.0, -1.2), None, np.inf),
    ],
)
def test_a_crossing_is_kept_clear_of_people_beside_it_who_do_not_wait_for_the_ego(
    walker: Walker, green: bool | None, line: float
) -> None:
    """They stood in its way on the crossing until their own light, and so did the ego."""
    crossing = replace(zebra(30.0, CrossingKind.UNMARKED), pedestrians_have_green=green)
    scene = perception(ego(speed=8.0), crossings=[crossing], walkers=[walker])
    place = np.array([32.0])
    found = keep_clear_of_people(scene, np.array([0]), np.array([walker.along]), place, np.array([np.inf]))
    assert found == line
