"""People beside the way: how near the true body comes to them, and how fast they are passed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analysis.thresholds import Thresholds
from controllers.arrays import FloatArray
from controllers.conflicts.bystanders import (
    BESIDE_WALKERS,
    FREE,
    NEAR,
    SETTING_OFF,
    SLOW,
    STOPPING,
    Bystanders,
    bystanders,
    speed_to_stop,
    swing_out,
)
from controllers.conflicts.expected_behaviour import Expectation, PedestrianAssumptions, Watch, expected
from controllers.interface import Body, CrossingKind, Perception, constant_command
from cosim.step.plant import CAR_DRIVE, Plant, body_of
from cosim.step.toy_road import ToyRoad, walk
from tests.controllers.scenes import Walker, bend, ego, perception, straight_road, zebra
from tests.controllers.toy_runs import Ride, ride

BODY = Body()


def _at_8_mps(places: FloatArray) -> FloatArray:
    return places / 8.0


def _beside(seen: Perception, enters: bool = False) -> Bystanders:
    nobody = np.full(len(seen.pedestrians), np.nan)
    found = bystanders(seen, 0.0, np.full(len(seen.pedestrians), enters), nobody, _at_8_mps)
    assert found is not None
    return found


def _stands(gap: float, along: float = 20.0, side: float = -1.0) -> Walker:
    """Return somebody who stands that far beside the body of an ego in the middle of its lane."""
    return Walker(along, side * (0.5 * BODY.width + 0.25 + gap))


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("gap", [0.1, 0.4, 1.0])
def test_the_distance_is_that_of_the_flank(gap: float, side: float) -> None:
    found = _beside(perception(ego(), walkers=[_stands(gap, side=side)]))
    assert found.least(1) == pytest.approx([gap])
    at_them = (found.places + BODY.front > 20.0) & (found.places - BODY.rear_overhang < 20.0)
    assert found.clearance[at_them, 0] == pytest.approx(gap)
    assert (found.clearance[~at_them, 0] > gap).all()


def test_nobody_near_is_nobody() -> None:
    for walkers in ([], [Walker(20.0, -8.0)], [Walker(-20.0, -1.5)]):
        seen, nobody = perception(ego(), walkers=walkers), np.full(len(walkers), np.nan)
        assert bystanders(seen, 0.0, np.zeros(len(walkers), bool), nobody, _at_8_mps) is None


def test_the_speed_is_bounded_beside_somebody_near_and_nowhere_else() -> None:
    found = _beside(perception(ego(), walkers=[_stands(NEAR)]))
    limit = found.speed_limit(np.zeros(0, dtype=np.int64))
    assert limit is not None
    places, allowed = limit
    assert allowed[(places + BODY.front > 20.5) & (places < 20.0)] == pytest.approx(SLOW)
    assert (allowed[places + BODY.front < 18.5] > 50.0).all()
    assert found.speed_limit(np.array([0])) is None, "whom the ego waits for is not passed"


@pytest.mark.parametrize("gap", [0.48, 0.6, 0.75])
def test_beside_somebody_who_waits_at_a_crossing_it_can_stop_before_they_reach_it(gap: float) -> None:
    """They set off at 1.5 m/s when the front has passed; the ego brakes with 8 m/s^2 after 0.25 s."""
    stands = _stands(gap)
    waits, stays = (
        _beside(perception(ego(), walkers=[replace(stands, waiting=waiting)])).speed_limit(
            np.zeros(0, dtype=np.int64)
        )
        for waiting in (True, False)
    )
    assert waits is not None
    assert stays is not None
    allowed = waits[1].min()
    assert 0.0 < allowed < stays[1].min()
    assert 0.25 + allowed / 8.0 == pytest.approx(gap / 1.5)


@pytest.mark.parametrize("gap", [0.3, 0.35, 0.4, 0.45, 0.5])
def test_who_sets_off_beside_a_slow_car_meets_a_standing_one(gap: float) -> None:
    """The car has its own lag, and plans 0.1 s after they set off. Standing is up to 0.1 m/s in our metrics."""
    plant = Plant(BODY, CAR_DRIVE, 0.0, 0.0, 0.0, float(speed_to_stop(np.array([gap]))[0]))
    plant.follow(constant_command(-STOPPING, 0.0), 0.0, gap / SETTING_OFF - 0.1)
    assert plant.speed < Thresholds().standing_speed_mps


@pytest.mark.parametrize(("gap", "slower"), [(0.45, True), (NEAR + 0.05, False)])
def test_who_walks_close_beside_the_way_may_step_aside(gap: float, slower: bool) -> None:
    stands = _stands(gap)
    standing, walking = (
        _beside(perception(ego(), walkers=[replace(stands, along_speed=pace)])).speed_limit(
            np.zeros(0, dtype=np.int64)
        )
        for pace in (0.0, -1.2)
    )
    assert standing is not None
    assert walking is not None
    assert walking[1].min() == (BESIDE_WALKERS if slower else standing[1].min())


WALKS_UP = Walker(30.0, -6.0, 0.0, 1.4, crossing=0, waiting=True)
"""To where a crossing begins at the edge of a lane."""


def _walks_up(speed: float, begins: float, walker: Walker = WALKS_UP) -> Bystanders | None:
    """Return who is beside an ego that meets somebody on the way to a crossing that it has priority at."""
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=begins)
    seen = perception(ego(speed), straight_road(), [walker], crossings=[crossing])
    return bystanders(seen, 0.0, np.zeros(1, dtype=np.bool_), np.full(1, np.nan), _at_8_mps)


@pytest.mark.parametrize("begins", [-1.5, -1.7])
def test_who_walks_up_to_a_crossing_is_passed_as_if_they_stood_there(begins: float) -> None:
    """The ego needs 26.5 m / 8 m/s = 3.3 s to get there, the pedestrian 4.5 m / 1.4 m/s = 3.2 s."""
    found = _walks_up(8.0, begins)
    assert found is not None
    assert found.least(1) == pytest.approx([-begins - 0.5 * BODY.width - 0.25])


def test_who_walks_up_to_a_crossing_and_comes_too_late_is_not_slowed_down_for() -> None:
    """In 1.9 s and one more they walk 4 m of the 4.5: the ego passes 0.8 m and more away from them."""
    found = _walks_up(14.0, -1.5)
    assert found is None or found.least(1) == pytest.approx(
        [6.0 - 1.4 * (26.45 / 14.0 + 1.0) - 1.15], abs=0.02
    )


@pytest.mark.parametrize("change", [{"across_speed": -1.4}, {"waiting": False}, {"across_speed": 0.1}])
def test_who_does_not_walk_up_to_the_crossing_counts_where_they_are(change: dict[str, object]) -> None:
    assert _walks_up(8.0, -1.5, replace(WALKS_UP, **change)) is None  # type: ignore[arg-type]


def test_beyond_a_distance_the_speed_is_free() -> None:
    far = _beside(perception(ego(), walkers=[_stands(FREE + 0.01)]))
    assert far.speed_limit(np.zeros(0, dtype=np.int64)) is None


def test_of_those_who_enter_only_who_is_beside_the_body_counts() -> None:
    seen = perception(ego(), walkers=[_stands(0.3), _stands(0.4, along=2.0)])
    assert _beside(seen, enters=True).least(2) == pytest.approx([np.inf, 0.4])


def _seen_to_stop(gap: float, pace: float, then: float = 0.0) -> tuple[Perception, Expectation]:
    """Return what an ego sees of somebody who walked across the road away from it, and stopped beside its way."""
    watch, assume = Watch(), PedestrianAssumptions()
    stands = _stands(gap, side=1.0)
    scenes = (
        replace(stands, across=stands.across - pace, across_speed=pace),
        replace(stands, across_speed=then),
    )
    for time, walker in enumerate(scenes):
        seen = perception(ego(time=float(time)), walkers=[walker])
        known = expected(seen, watch, assume, None)
    return seen, known


@pytest.mark.parametrize(("gap", "pace"), [(0.9, 1.6), (1.2, 1.9), (0.6, 1.2)])
def test_whoever_stopped_on_their_way_across_may_turn_back_as_fast_as_they_came(
    gap: float, pace: float
) -> None:
    seen, known = _seen_to_stop(gap, pace)
    found = bystanders(seen, 0.0, known.enters, known.sets_off, _at_8_mps)
    assert found is not None
    limit = found.speed_limit(np.zeros(0, dtype=np.int64))
    assert limit is not None
    allowed = limit[1].min()
    assert 0.25 + allowed / 8.0 == pytest.approx(gap / pace)


def test_who_slows_down_before_they_stop_came_as_fast_as_before() -> None:
    watch, assume = Watch(), PedestrianAssumptions()
    for time, (across, speed) in enumerate([(-1.6, 1.4), (-0.6, 0.7), (-0.2, 0.25), (0.0, 0.0)]):
        walker = replace(_stands(0.9, side=1.0), across_speed=speed)
        walker = replace(walker, across=walker.across + across)
        seen = perception(ego(time=float(time)), walkers=[walker])
        known = expected(seen, watch, assume, None)
    assert known.sets_off.tolist() == [1.4]


def test_who_stands_on_a_crossing_and_lets_the_ego_go_first_may_walk_on_beside_it() -> None:
    """A car that creeps past them is still there when its front is past; in SUMO they set off then."""
    watch, assume = Watch(), PedestrianAssumptions()
    stands = replace(_stands(0.6, along=6.0), crossing=0, on_crossing=True)
    for time in range(6):
        seen = perception(ego(0.0, time=float(time)), walkers=[stands], crossings=[zebra(5.0)])
        known = expected(seen, watch, assume, None)
    assert known.lets_go.all()
    found = bystanders(seen, 0.0, known.enters, known.sets_off, _at_8_mps)
    assert found is not None
    limit = found.speed_limit(np.zeros(0, dtype=np.int64))
    assert limit is not None
    assert 0.25 + limit[1].min() / 8.0 == pytest.approx(0.6 / assume.resume_speed)


def test_nothing_is_feared_of_those_who_walk_on_or_have_always_stood() -> None:
    _, known = _seen_to_stop(0.9, 1.6, then=1.0)
    assert np.isnan(known.sets_off).all()
    stood = perception(ego(), walkers=[_stands(0.9)])
    assert np.isnan(expected(stood, Watch(), PedestrianAssumptions(), None).sets_off).all()


@pytest.mark.parametrize(("along_speed", "goes_on_across"), [(-0.05, True), (-1.1, False)])
def test_only_who_stands_on_their_way_across_is_expected_to_go_on(
    along_speed: float, goes_on_across: bool
) -> None:
    """Whoever turns and walks along the road keeps that velocity: it may lead up to the ego."""
    watch, assume = Watch(), PedestrianAssumptions()
    scenes = Walker(3.0, 1.6, 0.0, -1.0), Walker(3.0, 1.4, along_speed, -0.1)
    for time, walker in enumerate(scenes):
        seen = perception(ego(0.0, time=float(time)), walkers=[walker])
        known = expected(seen, watch, assume, None)
    assert (known.comes is not None) == goes_on_across
    assert known.enters.all()
    assert known.across_speed == pytest.approx([-1.2 if goes_on_across else -0.1])


def test_the_front_swings_out_of_a_bend() -> None:
    road = bend(straight_road(), 10.0, 8.0, 12.0)
    right, left = swing_out(road, BODY, np.array([5.0, 18.0]))
    assert right == pytest.approx([0.0, 0.5 * BODY.front**2 / 8.0])
    assert left == pytest.approx([0.0, 0.0])
    outside = Walker(16.0, -(0.5 * BODY.width + 0.25 + 0.3))
    straight, turning = (_beside(perception(ego(), one, [outside])) for one in (straight_road(), road))
    assert straight.least(1) == pytest.approx([0.3])
    assert turning.least(1)[0] < 0.0, "a front that swings out comes nearer than the band says"


def test_the_front_of_a_bus_swings_farther_out_than_that_of_a_car() -> None:
    """By 3 m in a bend of 12 m: whoever stands there is in its way."""
    bus, road = body_of(12.0, 2.5), bend(straight_road(), 10.0, 12.0, 19.0)
    radius = 12.0 + 0.5 * bus.width
    swing = math.hypot(radius, bus.front) - radius
    right, left = swing_out(road, bus, np.array([24.0]))
    assert right == pytest.approx([swing], abs=1e-6)
    assert left == pytest.approx([0.0])
    outside = Walker(29.0, -(0.5 * bus.width + 0.25 + swing - 0.3))
    for body, near in ((bus, True), (BODY, False)):
        seen = perception(replace(ego(5.0), body=body), road, [outside])
        found = bystanders(seen, 0.0, np.zeros(1, dtype=np.bool_), np.full(1, np.nan), _at_8_mps)
        assert (found is not None) == near
        if found is not None:
            assert found.least(1)[0] < 0.0


def test_somebody_who_walks_towards_the_ego_counts_where_they_meet() -> None:
    road = bend(straight_road(), 10.0, 8.0, 12.0)
    beyond = Walker(40.0, -(0.5 * BODY.width + 0.25 + 0.3))
    speed = 4.0
    stands, comes = (
        _beside(perception(ego(speed=speed), road, [replace(beyond, along_speed=v)])) for v in (0.0, -3.0)
    )
    assert stands.least(1) == pytest.approx([0.3], abs=0.02)
    assert comes.least(1)[0] < 0.0, "in the bend, where the front swings out"


@pytest.mark.parametrize(
    ("curved", "pace", "slowly"), [(True, 1.2, True), (True, 0.0, False), (False, 1.2, False)]
)
def test_who_walks_along_a_bend_may_go_straight_on(curved: bool, pace: float, slowly: bool) -> None:
    """They come towards the ego on the inner side of its bend; straight on leads them into its way.

    The ego is 2.5 s and 20 m away then, and the pedestrian 3 m farther: 6.4 m from the bend's centre.
    """
    inside = 0.5 * BODY.width + 0.25 + 0.75
    road = bend(straight_road(), 10.0, 8.0, 12.5) if curved else straight_road()
    comes = Walker(10.0 + 8.0 * math.pi / 2.0 + 1.0, inside, -pace)
    found = _beside(perception(ego(8.0), road, [comes]))
    limit = found.speed_limit(np.zeros(0, dtype=np.int64))
    assert limit is not None
    assert (limit[1].min() == SLOW) == slowly
    assert found.least(1) == pytest.approx([0.75], abs=0.05), "nobody stands where they may walk"


def _passed(gap: float, lane_width: float, duration: float = 30.0) -> Ride:
    return ride(
        ToyRoad(lane_width=lane_width),
        [walk(80.0, -(0.5 * BODY.width + 0.25 + gap), 0.0, 0.0)],
        duration=duration,
    )


@pytest.mark.long
def test_people_on_both_sides_are_passed_at_the_speed_allowed_not_slower_and_slower() -> None:
    """8 m beside them at 1 m/s; an ego that waited for their end to come nearer took 28 s."""
    side = 0.5 * BODY.width + 0.25 + 0.2
    people = [walk(x, y, 0.0, 0.0) for x in (12.0, 15.0) for y in (-side, side)]
    record = ride(ToyRoad(lane_width=2.3), people, speed=0.0, duration=25.0)
    x, _, speed, _ = record.track
    assert speed[(x > 11.8) & (x < 15.2 + BODY.length)].max() < 1.1
    assert record.clearance() > 0.19
    assert record.arrival(25.0) < 19.0


@pytest.mark.long
@pytest.mark.parametrize("gap", [0.2, 0.35, 0.5])
def test_somebody_who_stands_in_the_lane_is_passed_slowly(gap: float) -> None:
    """The lane is too narrow to keep away from the pedestrian."""
    record = _passed(gap, 2.3)
    x, _, speed, _ = record.track
    beside = (x > 79.5) & (x < 80.5 + BODY.length)
    assert speed[beside].max() < 3.0
    assert record.clearance() > gap - 0.1
    assert record.arrival(90.0) < 29.0


@pytest.mark.long
def test_it_keeps_away_from_somebody_who_stands_in_the_lane() -> None:
    record = _passed(0.35, 3.5)
    assert record.clearance() > 0.6
    assert record.arrival(90.0) < 12.0
    assert abs(record.track[1][-1]) < 0.1, "and is back in the middle afterwards"


def test_somebody_who_stands_in_the_middle_is_not_passed() -> None:
    """Until the ego has waited for so long that it looks for a way out."""
    record = _passed(-1.0, 3.5, duration=15.0)
    assert record.track[2][-1] == 0.0
    assert record.clearance() > 1.0
    assert record.arrival(80.0) == float("inf")
