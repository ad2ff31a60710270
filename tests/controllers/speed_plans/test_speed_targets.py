"""Which obstacles plans are made for: whom the ego lets pass, and where it stops for them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import CrossingKind, Perception
from controllers.speed_plans.speed_targets import (
    CrossingRule,
    PedestrianTargets,
    SpeedTarget,
    Yielding,
    leaders,
    without,
)
from tests.controllers.scenes import FRONT, LANE_WIDTH, Car, Walker, ego, perception, straight_road, zebra

RULE = CrossingRule(standoff=2.5, side_margin=0.6, time_margin=1.0)


def _never(way: float) -> float:
    return math.inf


def _at_speed(speed: float) -> Callable[[float], float]:
    return lambda way: way / speed


def _found(
    scene: Perception, time_past: Callable[[float], float] = _never, targets: PedestrianTargets | None = None
) -> Yielding:
    return (targets or PedestrianTargets(RULE)).find(scene, 0.0, time_past)


def _crossing(across: float, speed: float, along: float = 42.0, time: float = 0.0) -> Perception:
    walker = Walker(along, across, 0.0, speed, 0, True)
    return perception(ego(10.0, time=time), straight_road(3, 1), [walker], crossings=[zebra(40.0)])


def test_on_a_crossing_the_stop_line_is_the_place_to_stop() -> None:
    found = _found(_crossing(-3.0, 1.2))
    (target,) = found.targets
    assert target.gap == pytest.approx(39.0 - FRONT)
    assert target.standoff == 0.0
    assert target.speed == 0.0
    assert target.body_gap == pytest.approx(42.0 - 0.25 - FRONT)
    assert target.leaves == pytest.approx((3.0 + 0.9 + 0.25 + 0.6) / 1.2)
    assert found.passing == "behind=person0 ahead="


def test_once_the_line_is_passed_the_pedestrian_is_the_obstacle() -> None:
    scene = perception(
        ego(3.0), walkers=[Walker(6.0, -1.0, 0.0, 1.2, 0, True)], crossings=[zebra(FRONT - 0.5)]
    )
    (target,) = _found(scene).targets
    assert target.key == "pedestrian person0"
    assert target.gap == pytest.approx(6.0 - 0.25 - FRONT)
    assert target.standoff == 2.5


def test_away_from_a_crossing_the_pedestrian_is_the_obstacle() -> None:
    (target,) = _found(perception(walkers=[Walker(30.0, 0.2)])).targets
    assert target.gap == pytest.approx(30.0 - 0.25 - FRONT)
    assert target.leaves == math.inf


@pytest.mark.parametrize(
    "walker",
    [
        Walker(42.0, -3.0, 0.0, 1.2, crossing=0, waiting=True),
        Walker(42.0, -1.0, 0.0, 0.0, crossing=0, on_crossing=True),
    ],
)
def test_who_has_not_begun_to_cross_or_stands_is_not_expected_to_leave(walker: Walker) -> None:
    (target,) = _found(perception(ego(10.0), walkers=[walker], crossings=[zebra(40.0)])).targets
    assert target.leaves == math.inf


def test_who_walks_towards_the_ego_along_the_road_is_nearer_when_they_enter_its_way() -> None:
    (target,) = _found(perception(walkers=[Walker(30.0, -3.0, -1.0, 1.0)])).targets
    assert target.gap < 30.0 - 0.25 - FRONT - 1.0


@pytest.mark.parametrize(("speed", "yields"), [(16.0, False), (10.0, True)])
def test_who_comes_into_the_way_after_the_ego_is_past_is_no_obstacle(speed: float, yields: bool) -> None:
    # In the way after (7 - 0.9 - 0.25 - 0.6) / 1.2 = 4.4 s; the ego is past after 44.2 m.
    found = _found(_crossing(-7.0, 1.2), _at_speed(speed))
    assert bool(found.targets) is yields
    assert found.passing == ("behind=person0 ahead=" if yields else "behind= ahead=person0")


def test_a_decision_is_changed_only_for_a_good_reason() -> None:
    enter = (7.0 - 0.9 - 0.25 - 0.6) / 1.2
    first = PedestrianTargets(RULE)
    ways = {"early": enter - 1.1, "late": enter - 0.6, "too late": enter - 0.2}
    for name, yields in (
        ("early", False),
        ("late", False),
        ("too late", True),
        ("late", True),
        ("early", True),
    ):
        found = _found(_crossing(-7.0, 1.2), lambda way, name=name: ways[name], first)  # type: ignore[misc]
        assert bool(found.targets) is yields
    assert not _found(_crossing(-7.0, 1.2), lambda way: enter - 2.1, first).targets


def test_somebody_in_the_way_is_never_gone_ahead_of() -> None:
    assert _found(_crossing(0.5, 1.2), lambda way: 0.0).targets


def test_of_several_at_one_crossing_who_leaves_last_counts() -> None:
    walkers = [Walker(42.0, across, 0.0, 1.2, 0, True) for across in (-1.0, -3.0, -2.0)]
    found = _found(perception(ego(10.0), walkers=walkers, crossings=[zebra(40.0)]))
    (target,) = found.targets
    assert target.name == "person1"
    assert target.leaves == pytest.approx((3.0 + 0.9 + 0.25 + 0.6) / 1.2)


def test_at_two_crossings_there_are_two_places() -> None:
    walkers = [Walker(42.0, -1.0, 0.0, 1.2, 0, True), Walker(72.0, -1.0, 0.0, 1.2, 1, True)]
    crossings = [zebra(40.0), replace(zebra(70.0), name="second zebra")]
    found = _found(perception(ego(10.0), walkers=walkers, crossings=crossings))
    assert [target.gap for target in found.targets] == pytest.approx([39.0 - FRONT, 69.0 - FRONT])


def test_five_hundred_at_one_crossing_are_one_place() -> None:
    walkers = [Walker(42.0, -4.0 + 0.01 * i, 0.0, 1.2, 0, True) for i in range(500)]
    assert len(_found(perception(ego(10.0), walkers=walkers, crossings=[zebra(40.0)])).targets) == 1


def test_who_is_beside_the_body_is_not_stopped_for_and_who_is_inside_it_is() -> None:
    beside = perception(ego(3.0), walkers=[Walker(1.0, 1.4)])
    inside = perception(ego(3.0), walkers=[Walker(1.0, 0.5)])
    assert not _found(beside).targets
    (target,) = _found(inside).targets
    assert target.gap == 0.0


@pytest.mark.parametrize(("kind", "yields"), [(CrossingKind.ZEBRA, True), (CrossingKind.UNMARKED, False)])
def test_who_waits_is_yielded_to_where_pedestrians_have_priority(kind: CrossingKind, yields: bool) -> None:
    walker = Walker(42.0, -3.0, crossing=0, waiting=True)
    scene = perception(ego(10.0), walkers=[walker], crossings=[zebra(40.0, kind)])
    assert bool(_found(scene).targets) is yields


def test_who_lets_the_ego_go_is_passed_slowly() -> None:
    targets = PedestrianTargets(RULE)
    scenes = [
        perception(
            ego(0.0, time=0.5 * step),
            walkers=[Walker(9.0, -3.0, crossing=0, waiting=True)],
            crossings=[zebra(7.0)],
        )
        for step in range(10)
    ]
    assert targets.careful_speed(scenes[0], 2.0) == math.inf
    for scene in scenes:
        found = _found(scene, _never, targets)
    assert not found.targets
    assert targets.careful_speed(scenes[-1], 2.0) == pytest.approx(RULE.assume.careful_speed, abs=0.5)


def test_leaders_are_targets_with_their_motion() -> None:
    scene = perception(ego(10.0), cars=[Car(40.0, 0.0, 6.0, acceleration=-1.0)])
    found, passed = leaders(scene, 0, DrivingStyle(standstill_gap=2.5), leaving=False)
    assert found == [SpeedTarget("car0", "car0", 40.0 - 4.5 - FRONT, 6.0, -1.0, 2.5)]
    assert not passed


def test_on_the_way_into_another_lane_its_leader_counts_too() -> None:
    cars = [Car(40.0, 0.0, 6.0), Car(30.0, LANE_WIDTH, 7.0)]
    scene = perception(ego(10.0), straight_road(2, 0), cars=cars)
    found, _ = leaders(scene, 1, DrivingStyle(), leaving=False)
    assert {target.name for target in found} == {"car0", "car1"}


def test_without_somebody_the_others_are_as_they_were() -> None:
    walkers = [Walker(30.0 + i, 0.1 * i, 0.0, 1.0, 0, True) for i in range(3)]
    scene = perception(walkers=walkers, cars=[Car(50.0, 0.0, 6.0)], crossings=[zebra(28.0)])
    fewer = without(scene, frozenset({"person1", "car0"}))
    assert fewer.pedestrians.names == ("person0", "person2")
    assert fewer.pedestrians.along.tolist() == [30.0, 32.0]
    assert fewer.pedestrians.on_crossing.tolist() == [True, True]
    assert len(fewer.vehicles) == 0
    assert without(scene, frozenset({"nobody"})).pedestrians is scene.pedestrians


def test_the_targets_say_whom_they_are_for() -> None:
    walkers = [Walker(42.0, -1.0, 0.0, 1.2, 0, True), Walker(42.0, -9.0, 0.0, 1.2, 0, True)]
    found = _found(
        perception(ego(10.0), straight_road(3, 1), walkers, crossings=[zebra(40.0)]), _at_speed(20.0)
    )
    assert found.names == frozenset({"person0"})
    assert found.passing == "behind=person0 ahead=person1"
