"""The last check: a plan that would touch somebody with a corner of the body is not carried out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.geometry.plane import people_in_plane, to_plane
from controllers.interface import Body, Command, CrossingKind, EgoState, Pedestrians, Perception, Plan
from controllers.prediction.constant_velocity import ConstantVelocity
from controllers.safety.last_check import SHIELDED, LastCheck
from controllers.safety.pedestrian_discs import discs
from controllers.safety.rollout import (
    PASSING_ACCELERATION,
    braked,
    course,
    passing_first,
    planned,
    poses,
)
from cosim.step.toy_road import ToyCrossing, ToyRoad, walk
from tests.controllers.scenes import FRONT, Walker, bend, ego, keeps, perception, straight_road, zebra
from tests.controllers.toy_runs import ride

BODY = Body()
TIMES = np.arange(0.0, 3.05, 0.1)


def _checked(walker: Walker, speed: float = 10.0, enters: bool = True) -> Plan:
    seen = perception(ego(speed=speed), straight_road(), [walker])
    return LastCheck().checked(seen, keeps(speed), np.array([enters]))


def _in_world(seen: Perception, position: FloatArray, velocity: FloatArray) -> Perception:
    people = replace(seen.pedestrians, position=position, velocity=velocity)
    return replace(seen, pedestrians=people)


def test_a_plan_with_nobody_near_is_carried_out_as_it_is() -> None:
    plan = keeps(10.0)
    seen = perception(ego(speed=10.0), straight_road())
    assert LastCheck().checked(seen, plan, np.zeros(0, dtype=np.bool_)) is plan


@pytest.mark.parametrize("across", [0.0, 1.0, -1.1])
def test_somebody_who_stands_in_front_is_braked_for(across: float) -> None:
    plan = _checked(Walker(16.0, across, 0.0, 0.0))
    assert plan.status == SHIELDED
    assert plan.command.acceleration.max() <= -3.5


def test_a_plan_that_brakes_harder_than_is_needed_is_not_made_weaker() -> None:
    """4.5 m/s^2 would do for somebody who stands 16 m ahead of the bumper."""
    seen = perception(ego(speed=10.0), straight_road(), [Walker(20.0, 0.0)])
    for planned_braking, done in ((0.0, -4.5), (6.0, -6.0)):
        command = Command(np.zeros(1), np.full(1, -planned_braking), np.zeros(1))
        checked = LastCheck().checked(seen, replace(keeps(10.0), command=command), np.array([False]))
        assert checked.status == SHIELDED
        assert checked.command.acceleration.tolist() == [done]


def test_no_more_braking_is_asked_for_than_the_car_has() -> None:
    weak = replace(ego(speed=10.0), drive=replace(ego().drive, max_deceleration=4.0))
    for along in (20.0, 9.0):
        seen = perception(weak, straight_road(), [Walker(along, 0.0)])
        checked = LastCheck().checked(seen, keeps(10.0), np.array([False]))
        assert checked.status == SHIELDED
        assert set(checked.command.acceleration) == {-4.0}


def test_braking_that_the_car_does_not_have_is_no_way_to_stop_before_somebody() -> None:
    """Braked at 8 m/s^2, the ego stops before them, at 4 m/s^2 beside them; a little faster, it is past."""
    for strongest, asked in ((8.0, -8.0), (4.0, PASSING_ACCELERATION)):
        state = replace(ego(speed=6.0), drive=replace(ego().drive, max_deceleration=strongest))
        seen = perception(state, straight_road(), [Walker(6.0, -2.5, 0.0, 1.0)])
        checked = LastCheck().checked(seen, keeps(6.0), np.array([True]))
        assert checked.status == SHIELDED
        assert set(checked.command.acceleration) == {asked}


@pytest.mark.parametrize(("interval", "status"), [(0.1, "ok"), (1.0, SHIELDED)])
def test_braking_is_left_to_the_plan_only_if_it_can_still_be_done_at_the_next_plan(
    interval: float, status: str
) -> None:
    seen = perception(ego(5.0, plan_interval=interval), straight_road(), [Walker(FRONT + 6.85, 0.0)])
    assert LastCheck().checked(seen, keeps(5.0), np.array([False])).status == status


def test_how_somebody_sets_off_is_known_better_than_any_forecast_says() -> None:
    """Two stand at the same place; of the first it is known that they come. The forecast has both standing."""
    seen = perception(ego(8.0), straight_road(), [Walker(20.0, -3.0), Walker(20.0, -3.0)])
    forecast = ConstantVelocity().predict(seen, np.arange(6.0))
    found = discs(
        seen, np.arange(2), np.ones(2, bool), forecast, np.arange(3.0), across_speed=np.array([1.2, np.nan])
    )
    np.testing.assert_allclose(found.y, [[-3.0, -1.8, -0.6], [-3.0, -3.0, -3.0]])


def test_somebody_beside_the_body_and_the_margin_is_not_braked_for() -> None:
    assert _checked(Walker(16.0, 0.5 * BODY.width + 0.25 + 0.15, 0.0, 0.0)).status == "ok"


def test_it_does_not_brake_as_long_as_comfortable_braking_would_do() -> None:
    assert _checked(Walker(29.0, 0.0, 0.0, 0.0)).status == "ok"


@pytest.mark.parametrize(("gap", "brakes"), [(0.5, True), (0.8, True), (1.5, False)])
def test_a_slow_ego_does_not_wait_until_somebody_has_walked_up_to_it(gap: float, brakes: bool) -> None:
    """It could stop in 0.2 s at any time; they are there in less than 0.7 s, or later."""
    towards_the_flank = Walker(1.0, -(0.5 * BODY.width + 0.25 + gap), 0.0, 1.3)
    checked = _checked(towards_the_flank, speed=0.4)
    assert (checked.status == SHIELDED) == brakes
    assert checked.command.acceleration.max() <= -3.0 if brakes else checked.command.acceleration.max() == 0.0


@pytest.mark.parametrize(("along", "status"), [(BODY.front - 0.5, SHIELDED), (BODY.front + 0.5, "ok")])
def test_braking_for_somebody_beside_the_body_is_not_left_to_the_plan(along: float, status: str) -> None:
    """Mild braking would do for both, but only for those ahead of the bumper does the plan do it."""
    towards_the_way = Walker(along, -(0.5 * BODY.width + 0.25 + 1.9), 1.3, 1.3)
    checked = _checked(towards_the_way, speed=3.0)
    assert checked.status == status
    assert checked.command.acceleration.min() == (-3.0 if status == SHIELDED else 0.0)


def test_somebody_who_may_not_enter_counts_where_they_are() -> None:
    steps_out = Walker(16.0, -2.4, 0.0, 1.2)
    assert _checked(steps_out).status == SHIELDED
    assert _checked(steps_out, enters=False).status == "ok"
    assert _checked(replace(steps_out, across=-0.9), enters=False).status == SHIELDED


def test_somebody_who_walks_along_the_road_goes_on_and_is_not_waited_for_to_stand() -> None:
    in_the_lane, speed = Walker(11.6, 0.8), 5.0
    assert _checked(in_the_lane, speed, enters=False).status == "ok"
    towards = replace(in_the_lane, along_speed=-1.4)
    assert _checked(towards, speed, enters=False).status == SHIELDED
    at_a_crossing = replace(towards, crossing=0)
    assert _checked(at_a_crossing, speed, enters=False).status == "ok"


def test_somebody_who_walks_may_step_aside_and_counts_with_more_distance() -> None:
    beside = 0.5 * BODY.width + 0.25 + 0.2
    assert _checked(Walker(5.0, beside, 0.0, 0.0), speed=5.0).status == "ok"
    assert _checked(Walker(5.0, beside, -0.5, 0.0), speed=5.0).status == SHIELDED


@pytest.mark.parametrize("enters", [True, False])
def test_no_hard_braking_that_ends_beside_somebody_whom_the_ego_would_have_passed(enters: bool) -> None:
    """They walk towards the flank: at 9 m/s it is past before they are there, braked to a stop it is not."""
    towards_the_flank = Walker(BODY.front + 1.2, -2.15, 0.0, 1.2)
    passing = _checked(towards_the_flank, speed=9.0, enters=enters)
    assert passing.command.acceleration.min() > -3.5
    nearer = replace(towards_the_flank, across=-1.6)
    assert _checked(nearer, speed=9.0, enters=enters).command.acceleration.max() == -8.0


def test_a_slowing_ego_gets_past_somebody_who_walks_up_to_its_flank() -> None:
    """Neither the plan nor any braking would clear them; the ego that speeds up a little does."""
    speed, slowing = 7.5, 2.3
    keeping = keeps(speed)
    slower = replace(
        keeping,
        along=speed * keeping.times - 0.5 * slowing * keeping.times**2,
        speed=np.maximum(speed - slowing * keeping.times, 0.0),
        command=replace(keeping.command, acceleration=np.full(len(keeping.command.times), -slowing)),
    )
    walker = Walker(BODY.front + 0.9, -2.3, 0.0, 1.4, waiting=True)
    seen = perception(ego(speed=speed), straight_road(), [walker])
    checked = LastCheck().checked(seen, slower, np.array([False]))
    assert checked.status == SHIELDED
    assert checked.command.acceleration.min() == PASSING_ACCELERATION
    motion = passing_first(seen, TIMES)
    rear = motion.along[:, 0] - BODY.rear_overhang
    arrives = (2.3 - 0.5 * BODY.width - 0.25) / 1.4
    assert np.interp(arrives, TIMES, rear) > BODY.front + 0.9 + 0.25, "it is past when they are there"


@pytest.mark.parametrize("on_crossing", [True, False])
def test_a_first_step_onto_a_crossing_that_leads_behind_the_ego_is_no_reason_to_hurry(
    on_crossing: bool,
) -> None:
    """SUMO shifts people sideways as they set off; then they walk straight across, into the flank."""
    speeding_up = replace(keeps(1.5), command=Command(np.zeros(1), np.array([0.95]), np.zeros(1)))
    sets_off = Walker(BODY.front - 3.5, -1.72, -1.6, 1.4, crossing=0, on_crossing=on_crossing)
    going = replace(ego(speed=1.48), acceleration=0.96)
    seen = perception(going, straight_road(), [sets_off], crossings=[zebra(0.0)])
    checked = LastCheck().checked(seen, speeding_up, np.array([True]))
    assert (checked.command.acceleration.max() < -3.0) == on_crossing


@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_somebody_who_walks_to_a_waiting_place_in_the_lane_is_braked_for_before_they_turn(
    speed: float,
) -> None:
    walker = Walker(3.0, -2.6, 1.2, 0.0, crossing=0, waiting=True)
    seen = perception(ego(speed=speed), straight_road(), [walker], crossings=[zebra(2.0)])
    check, comes = LastCheck(), np.array([1.2])
    assert check.checked(seen, keeps(3.0), np.array([True])).status == "ok"
    assert check.checked(seen, keeps(3.0), np.array([True]), comes=comes).status == SHIELDED


@pytest.mark.parametrize(("across_speed", "status"), [(-0.3, SHIELDED), (0.3, "ok")])
def test_somebody_who_still_walks_away_from_their_waiting_place_has_to_turn_first(
    across_speed: float, status: str
) -> None:
    """They were taken to walk straight to it, and walked into the flank of an ego that rolled past."""
    beside = Walker(1.0, 0.5 * BODY.width + 0.25 + 0.26, -0.2, across_speed, 0, waiting=True)
    seen = perception(ego(speed=0.4), straight_road(), [beside], crossings=[zebra(6.0)])
    checked = LastCheck().checked(seen, keeps(0.4), np.full(1, True), comes=np.array([1.2]))
    assert checked.status == status


def test_somebody_who_stands_on_a_crossing_and_will_walk_on_keeps_an_ego_from_starting() -> None:
    beside = Walker(1.0, -1.8, 0.0, 0.0, crossing=0, on_crossing=True)
    seen = perception(ego(speed=0.0), straight_road(), [beside], crossings=[zebra(-1.0)])
    check = LastCheck()
    assert check.checked(seen, keeps(2.0), np.array([True])).status == "ok"
    assert check.checked(seen, keeps(2.0), np.array([True]), comes=np.array([1.2])).status == SHIELDED


def test_an_ego_does_not_start_while_somebody_touches_it_or_stands_in_its_way() -> None:
    beside = Walker(1.0, 0.5 * BODY.width + 0.25, 0.0, 0.0)
    near = Walker(BODY.front + 1.0, 0.5 * BODY.width + 0.25 + 0.15, 0.0, 0.0)
    for walker in (beside, near):
        seen = perception(ego(speed=0.0), straight_road(), [walker])
        plan = LastCheck().checked(seen, keeps(2.0), np.array([False]))
        assert plan.command.acceleration.max() < 0.0


def test_an_ego_that_creeps_past_somebody_goes_on_and_one_that_stood_there_does_not_start() -> None:
    beside = Walker(1.0, 0.5 * BODY.width + 0.25 + 0.12, 0.0, 0.0)

    def status(check: LastCheck, speed: float) -> str:
        seen = perception(ego(speed=speed), straight_road(), [beside])
        return check.checked(seen, keeps(0.4), np.array([False])).status

    creeps, starts = LastCheck(), LastCheck()
    assert status(creeps, 0.4) == "ok"
    assert status(starts, 0.0) == SHIELDED
    assert status(starts, 0.4) == SHIELDED
    # Under way again, it may creep.
    assert status(starts, 0.6) == "ok"
    assert status(starts, 0.4) == "ok"


def test_somebody_beside_a_waiting_ego_who_does_not_move_holds_it_for_a_while_only() -> None:
    check, near = LastCheck(), Walker(2.0, 0.5 * BODY.width + 0.25 + 0.15, 0.0, 0.0)
    held = []
    for tick in range(60):
        seen = perception(ego(speed=0.0, time=0.1 * tick), straight_road(), [near])
        held.append(check.checked(seen, keeps(2.0), np.array([False])).status == SHIELDED)
    assert held[0]
    assert not held[-1]


def test_fallbacks_without_a_horizon_are_checked_too() -> None:
    command = Command(np.zeros(1), np.array([-1.0]), np.zeros(1))
    seen = perception(ego(speed=10.0), straight_road(), [Walker(16.0, 0.0, 0.0, 0.0)])
    plan = LastCheck().checked(seen, Plan(command, solved=False, status="fallback"), np.array([False]))
    assert plan.status == SHIELDED
    assert not plan.solved
    assert plan.command.acceleration[0] <= -3.5


def test_a_fallback_with_which_a_standing_ego_would_start_is_checked_too() -> None:
    command = Command(np.zeros(1), np.array([2.0]), np.zeros(1))
    for ahead, status in ((1.0, SHIELDED), (20.0, "fallback")):
        seen = perception(ego(speed=0.0), straight_road(), [Walker(FRONT + ahead, 0.0)])
        plan = LastCheck().checked(seen, Plan(command, solved=False, status="fallback"), np.array([False]))
        assert plan.status == status


def test_the_front_corner_that_swings_out_in_a_tight_bend_is_seen() -> None:
    """At a radius of 6 m a car's outer front corner is 1.05 m farther out than its side."""
    road = bend(straight_road(), 0.0, 6.0, 9.0)
    car = ego(speed=4.0)
    # Outside of the bend, 0.5 m beyond what half the body's width reaches on the path.
    (place,), _ = to_plane(road, np.array([6.0]), np.array([-(0.5 * BODY.width + 0.25 + 0.5)]))
    seen = perception(car, road, [Walker(50.0, 5.0, 0.0, 0.0)])
    seen = _in_world(seen, np.array([place]), np.zeros((1, 2)))
    assert LastCheck().checked(seen, keeps(4.0), np.array([False])).status == SHIELDED
    far, _ = to_plane(road, np.array([6.0]), np.array([-(0.5 * BODY.width + 0.25 + 2.5)]))
    seen = _in_world(seen, far, np.zeros((1, 2)))
    assert LastCheck().checked(seen, keeps(4.0), np.array([False])).status == "ok"


def test_a_rollout_follows_the_plan_and_the_bend() -> None:
    road = bend(straight_road(), 0.0, 20.0, 40.0)
    angle = math.atan(BODY.wheelbase / 20.0)
    seen = perception(ego(speed=5.0, steering=angle), road)
    plan = replace(keeps(5.0), command=Command(np.zeros(1), np.zeros(1), np.array([angle])))
    motion = planned(seen, plan, TIMES)
    x, y, heading = poses(seen, course(seen, plan, motion, TIMES), motion)
    turned = 5.0 * TIMES / 20.0
    assert x[:, 0] == pytest.approx(20.0 * np.sin(turned), abs=0.05)
    assert y[:, 0] == pytest.approx(20.0 * (1.0 - np.cos(turned)), abs=0.05)
    assert heading[:, 0] == pytest.approx(turned, abs=0.02)


@pytest.mark.parametrize("across", [3.0, -3.0])
def test_steering_beside_the_centre_line_of_a_bend_leads_round_the_same_middle(across: float) -> None:
    road, radius = bend(straight_road(), 0.0, 20.0, 40.0), 20.0 - across
    angle = math.atan(BODY.wheelbase / radius)
    seen = perception(ego(speed=5.0, across=across, steering=angle), road)
    plan = replace(keeps(5.0), command=Command(TIMES, 0.0 * TIMES, 0.0 * TIMES + angle))
    motion = planned(seen, plan, TIMES)
    x, y, heading = poses(seen, course(seen, plan, motion, TIMES), motion)
    turned = motion.along[:, 0] / 20.0  # along the centre line
    assert x[:, 0] == pytest.approx(radius * np.sin(turned), abs=0.05)
    assert y[:, 0] == pytest.approx(20.0 - radius * np.cos(turned), abs=0.05)
    assert heading[:, 0] == pytest.approx(turned, abs=0.02)


def test_wheels_lag_behind_what_is_commanded() -> None:
    """Behind a lag of 0.3 s, a car at 3 m/s has turned by 0.3 s * 3 m/s * tan(0.2) / 2.6 m less."""
    car = replace(ego(speed=3.0), drive=replace(ego().drive, steering_lag=0.3))
    seen = perception(car, straight_road())
    plan = replace(keeps(3.0), command=Command(TIMES, 0.0 * TIMES, 0.0 * TIMES + 0.2))
    path = course(seen, plan, planned(seen, plan, TIMES), TIMES)
    rate = 3.0 * math.tan(0.2) / BODY.wheelbase
    # The command is there until 3 s: at a constant rate but for what the lag has cost.
    assert path.heading_error.max() == pytest.approx(rate * (3.0 - 0.3), abs=0.01)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_the_steering_leads_counts_and_not_where_the_plan_meant_to_be(side: float) -> None:
    """A plan straight on whose wheels are turned comes aside at once."""
    beside = Walker(BODY.front + 0.8, side * (0.5 * BODY.width + 0.25 + 0.15))
    seen = perception(ego(speed=3.0, steering=side * 0.4), straight_road(), [beside])
    times = np.arange(0.0, 1.5, 0.05)
    turned = Command(times, 0.0 * times, np.full(len(times), side * 0.4))
    checked = LastCheck().checked(seen, replace(keeps(3.0), command=turned), np.array([False]))
    assert checked.status == SHIELDED
    assert LastCheck().checked(seen, keeps(3.0), np.array([False])).status == "ok"


def test_braking_behind_its_lag_takes_the_way_it_should_and_ends_in_a_standstill() -> None:
    seen = perception(ego(speed=10.0), straight_road())
    motion = braked(seen, np.array([5.0]), np.arange(0.0, 5.0, 0.01))
    assert motion.speed[-1, 0] == 0.0
    # v^2 / 2 b and the lag's v T, less a little as the deceleration is not sudden.
    assert motion.along[-1, 0] == pytest.approx(10.0 + 10.0 * 0.35, abs=0.4)


def test_places_in_the_world_are_those_of_the_route_where_the_road_is_straight() -> None:
    turned = EgoState(
        "ego", 0.0, 100.0, 50.0, 0.7, 0.4, 0.1, 5.0, 0.0, 0.0, BODY, ego().drive, plan_interval=0.1
    )
    line, offset = 0.6, np.array([3.0, -2.0])
    forward, left = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    origin = np.array([100.0, 50.0]) - 0.4 * left
    seen = perception(turned, straight_road(), [Walker(3.0, -2.0, 1.0, 0.5)])
    seen = _in_world(
        seen, np.array([origin + offset[0] * forward + offset[1] * left]), np.array([forward + 0.5 * left])
    )
    people: Pedestrians = seen.pedestrians
    known = people_in_plane(turned, seen.road, people)
    told = people_in_plane(turned, seen.road, replace(people, position=np.full((1, 2), np.nan)))
    for one, other in zip(known, told, strict=True):
        assert one == pytest.approx(other)


def test_somebody_who_stands_in_the_lane_without_priority_is_not_run_over() -> None:
    """On a crossing where people have to wait, somebody waits on the carriageway itself."""
    controller = catalog.build("vo_mpc")
    walker = Walker(20.0, 0.3, 0.0, 0.0, 0, waiting=True)
    road = straight_road()
    crossing = zebra(18.0, CrossingKind.UNMARKED)
    seen = perception(ego(speed=8.0), road, [walker], crossings=[crossing])
    plan = controller.plan(seen, controller.decide(seen))
    assert "person0" in plan.passing
    assert plan.along.max() + BODY.front < 20.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_in_closed_loop_somebody_who_stops_beside_the_middle_of_the_lane_is_not_touched(side: float) -> None:
    road = ToyRoad(crossings=(ToyCrossing(60.0),))
    record = ride(road, [walk(62.0, -4.0 * side, 0.0, 1.2 * side, stop=3.0)], duration=12.0)
    assert record.clearance() > 0.2
