"""What is expected of pedestrians who stand: who walks on, and who lets the ego go first."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch, expected
from controllers.interface import CrossingKind
from cosim.step.plant import body_of
from tests.controllers.conflicts.found import found_among, on_zebra
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road, zebra


def test_somebody_who_stops_on_the_crossing_is_expected_to_walk_on_the_way_they_came() -> None:
    watch = Watch()
    found_among([], on_zebra([Walker(30.0, -3.0, 0.0, 1.3, 0, True)]), watch)
    assert watch.heading == {"person0": 1.0}
    standing = found_among([], on_zebra([Walker(30.0, -2.5, 0.0, 0.0, 0, True)]), watch)
    assert standing.across_speed[0] == pytest.approx(1.2)


@pytest.mark.parametrize(("kind", "towards"), [(CrossingKind.ZEBRA, 1.2), (CrossingKind.UNMARKED, None)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_who_stands_on_a_crossing_and_was_never_seen_walking_comes_if_they_have_priority(
    kind: CrossingKind, towards: float | None, side: float
) -> None:
    found = found_among([], on_zebra([Walker(30.0, -2.5 * side, 0.0, 0.0, 0, True)], kind))
    assert found.across_speed.tolist() == ([] if towards is None else [towards * side])


@pytest.mark.parametrize(("drifts", "lets_go"), [(0.0, True), (0.3, False)])
def test_who_stands_is_seen_to_although_velocities_are_only_estimated(drifts: float, lets_go: bool) -> None:
    watch, noise = Watch(), np.random.default_rng(1)
    for step in range(60):
        slow = (noise.normal(size=2) * 0.2).tolist()
        stands = Walker(FRONT + 5.0, -3.0, slow[0], slow[1], crossing=0, waiting=True)
        seen = perception(ego(0.0, time=step / 10.0), walkers=[stands], crossings=[zebra(FRONT + 3.0)])
        place = np.array([[drifts * step / 10.0, 0.0]]) + noise.normal(size=2) * 0.1
        people = replace(seen.pedestrians, uncertainty=np.array([0.1]), position=place)
        known = expected(replace(seen, pedestrians=people), watch, PedestrianAssumptions(), None)
    assert known.lets_go.all() == lets_go


@pytest.mark.parametrize(("seems", "stays"), [(0.0, True), (0.4, True), (0.4, False)])
def test_who_stops_in_the_road_walks_on_although_their_velocity_is_only_estimated(
    seems: float, stays: bool
) -> None:
    """An error along the road does not make somebody who stands a walker along it; moving away does."""
    watch, assume = Watch(), PedestrianAssumptions()
    places = [(20.0, -1.0), (20.0, -0.5), (20.0 if stays else 21.0, -0.5)]
    velocities = [(0.0, 1.2), (0.0, 0.0), (seems, 0.1)]
    for step, ((along, across), velocity) in enumerate(zip(places, velocities, strict=True)):
        walkers = [Walker(along, across, *velocity)]
        seen = perception(ego(time=step / 10.0), road=straight_road(3, 1), walkers=walkers)
        place = np.array([[along, across]])
        people = replace(seen.pedestrians, uncertainty=np.array([0.1]), position=place)
        known = expected(replace(seen, pedestrians=people), watch, assume, None)
    assert known.across_speed[0] == pytest.approx(1.2 if stays else 0.1)


@pytest.mark.parametrize(
    ("line", "before", "waits"),
    [(FRONT + 2.0, 12.0, True), (FRONT + 2.0, 9.0, True), (FRONT + 6.0, 12.0, False)],
)
def test_an_ego_waits_where_it_has_to_stop_for_a_crossing_however_wide_that_is(
    line: float, before: float, waits: bool
) -> None:
    """Zebras are up to 8 m wide, and their lines up to 8 m before them."""
    watch, assume = Watch(), PedestrianAssumptions()
    crossing = replace(zebra(line + before), stop_line=line)
    stands = Walker(line + before + 3.0, -3.0, crossing=0, waiting=True)
    for time in range(5):
        seen = perception(ego(0.0, time=float(time)), walkers=[stands], crossings=[crossing])
        known = expected(seen, watch, assume, None)
    assert stands.along > assume.waiting_within
    assert known.lets_go.all() == waits


@pytest.mark.parametrize(("between", "waits"), [(3.0, True), (8.0, False)])
def test_an_ego_without_room_between_two_crossings_waits_before_the_first_for_people_at_the_second(
    between: float, waits: bool
) -> None:
    watch, assume = Watch(), PedestrianAssumptions()
    first, second = zebra(FRONT + 2.0, width=4.0), zebra(FRONT + 6.0 + between, width=8.0)
    stands = Walker(second.exit - 1.0, -3.0, crossing=1, waiting=True)
    for time in range(5):
        seen = perception(ego(0.0, time=float(time)), walkers=[stands], crossings=[first, second])
        known = expected(seen, watch, assume, None)
    assert known.lets_go.all() == waits


def test_who_has_waited_at_red_lets_nobody_go_first_at_green() -> None:
    """An ego that turns waits at the same red light; both may go now, and the pedestrian first."""
    watch, assume = Watch(), PedestrianAssumptions()
    waits = Walker(FRONT + 8.0, -4.3, 0.0, 0.0, 0, waiting=True)
    for second in range(12):
        light = replace(zebra(FRONT + 6.0, CrossingKind.SIGNAL), pedestrians_have_green=second > 9)
        seen = perception(ego(0.0, time=float(second)), straight_road(1), [waits], crossings=[light])
        known = [expected(seen, watch, assume, None) for _ in range(2)][-1]
        assert known.lets_go.tolist() == [3 <= second <= 9]
    assert known.enters.all()


def test_who_is_seen_for_the_first_time_has_not_waited_yet() -> None:
    watch = Watch()
    for second in range(3):
        stands = [Walker(FRONT + 5.0, -3.0, 0.0, 0.0, 0)]
        watch.look(
            perception(ego(0.0, time=float(second)), straight_road(3, 1), stands), PedestrianAssumptions()
        )
        assert watch.waited == {"person0": float(second)}


@pytest.mark.parametrize("length", [4.5, 12.0, 18.0])
def test_whoever_stands_before_a_waiting_bus_lets_it_go_first_as_they_let_a_car(length: float) -> None:
    """Its front bumper is up to 14 m ahead of the rear axle, from which distances are told."""
    watch, body = Watch(), body_of(length, 2.0)
    stands = Walker(body.front + 7.0, -3.0, crossing=0, waiting=True)
    for time in range(5):
        state = replace(ego(0.0, time=float(time)), body=body)
        seen = perception(state, straight_road(), [stands], crossings=[zebra(body.front + 5.0)])
        known = expected(seen, watch, PedestrianAssumptions(), None)
        assert known.lets_go.all() == (time >= 3)


COURTEOUS = PedestrianAssumptions(courtesy=1.0)


@pytest.mark.parametrize("across", [-4.0, 4.0])
def test_an_ego_at_rest_lets_those_who_stand_at_an_unmarked_crossing_go_first(across: float) -> None:
    """Until they have not stepped onto it for so long; and it forgets that when they walk."""
    watch = Watch()
    expected_speeds = [_standing_at_a_crossing(watch, 0.0, time / 4.0, across) for time in range(7)]
    towards = math.copysign(1.2, -across)
    assert expected_speeds == [towards] * 4 + [0.0] * 3
    assert _standing_at_a_crossing(watch, 1.0, 2.0, across) == 0.0
    assert _standing_at_a_crossing(watch, 0.0, 2.5, across) == 0.0
    walks = Walker(FRONT + 3.0, across - towards, 0.0, towards, 0, waiting=True)
    watch.look(perception(ego(0.0, time=2.75), walkers=[walks]), COURTEOUS)
    assert _standing_at_a_crossing(watch, 0.0, 3.0, across) == towards


def test_an_ego_that_rolls_to_its_line_stops_there_for_them_and_one_that_drives_does_not() -> None:
    watch = Watch()
    rolling = [_standing_at_a_crossing(watch, 1.4 - 0.3 * time, time / 2.0) for time in range(5)]
    assert rolling == [1.2] * 5
    assert _standing_at_a_crossing(watch, 1.6, 2.5) == 0.0


def test_only_before_a_crossing_without_priority_does_the_ego_let_them_go_first() -> None:
    assert _standing_at_a_crossing(Watch(), 0.0, 0.0, kind=CrossingKind.SIGNAL) == 0.0
    assert _standing_at_a_crossing(Watch(), 0.0, 0.0, entry=FRONT - 0.1) == 0.0
    assert _standing_at_a_crossing(Watch(), 0.0, 0.0, assume=PedestrianAssumptions()) == 0.0


def _standing_at_a_crossing(
    watch: Watch,
    speed: float,
    time: float,
    across: float = -4.0,
    kind: CrossingKind = CrossingKind.UNMARKED,
    entry: float = FRONT + 1.0,
    assume: PedestrianAssumptions = COURTEOUS,
) -> float:
    """Return the speed across that is expected of somebody who stands at a crossing's end [m/s]."""
    crossing = replace(zebra(entry, kind), pedestrians_have_green=False)
    stands = Walker(entry + 2.0, across, crossing=0, waiting=True)
    seen = perception(ego(speed, time=time), straight_road(), [stands], crossings=[crossing])
    return float(expected(seen, watch, assume, None).across_speed[0])
