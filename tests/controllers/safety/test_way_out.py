"""An ego that is kept from starting finds a way round those who stay, and comes back into its lane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from analysis.thresholds import Thresholds
from controllers import catalog
from controllers.interface import Body, Crossing, Perception, Plan, Signal, SignalState
from controllers.safety.free_way import DRIFT
from controllers.safety.last_check import SHIELDED, WAY_OUT, LastCheck
from controllers.safety.way_out import (
    A_CYCLE,
    BRUSHED,
    BRUSHING,
    CLOSE,
    INCHING,
    LAST_RESORT,
    LET_GO,
    PAST,
    PATIENCE,
    SOUGHT_EVERY,
    SPEED,
    Reach,
)
from cosim.step.toy_road import ToyRoad, walk
from tests.controllers.scenes import Car, Walker, ego, keeps, perception, straight_road, zebra
from tests.controllers.toy_runs import ride

BODY = Body()
ROW = [(8.0, float(y)) for y in np.arange(-1.6, 1.7, 0.8)]
"""People across the lane and to either side of it, who can only be gone round beside the road."""


def _held(
    walkers: Sequence[Walker],
    seconds: float,
    cars: Sequence[Car] = (),
    room: float = np.inf,
    stuck: bool = True,
    crossings: Sequence[Crossing] = (),
    signals: Sequence[Signal] = (),
    step: float = 0.1,
) -> list[Plan]:
    """Return what the last check makes, at every step [s], of an ego that stands for so long."""
    check, plans = LastCheck(), []
    for tick in range(round(seconds / step)):
        state = ego(speed=0.0, time=step * tick)
        seen: Perception = perception(state, straight_road(2), walkers, cars, crossings, signals)
        plans.append(check.checked(seen, keeps(2.0), np.zeros(len(walkers), bool), None, Reach(stuck, room)))
    return plans


AT_THE_CORNER = Walker(BODY.front + 0.9, -1.05)
PASSED, AHEAD = (Signal("light", BODY.front + far, SignalState.GREEN) for far in (-1.0, 12.0))


def test_it_is_taken_after_a_while() -> None:
    plans = _held([AT_THE_CORNER], PATIENCE + 1.0)
    statuses = [plan.status for plan in plans]
    assert set(statuses[: int(10 * PATIENCE)]) == {SHIELDED}
    assert statuses[-1] == WAY_OUT
    # The wheels are turned before it drives.
    first = plans[statuses.index(WAY_OUT)].command
    assert first.steering[0] > 0.1
    assert first.acceleration[0] < 0.0


@pytest.mark.long
def test_the_lane_is_left_for_the_pavement_as_a_last_resort_only() -> None:
    held = _held([Walker(*place) for place in ROW], LAST_RESORT + 2.0, step=SOUGHT_EVERY)
    statuses = [plan.status for plan in held]
    assert WAY_OUT not in statuses[: int(LAST_RESORT / SOUGHT_EVERY)]
    assert statuses[-1] == WAY_OUT


@pytest.mark.long
@pytest.mark.parametrize(("begins", "soon"), [(BODY.front + 0.5, False), (-1.0, True), (40.0, True)])
def test_before_a_crossing_a_way_that_does_not_lead_over_it_is_the_last_resort(
    begins: float, soon: bool
) -> None:
    """On a crossing, or far from any, such a way is taken as soon as others."""
    across = Car(14.0, 0.0, heading_error=0.5 * np.pi, length=6.0)
    crossings = [zebra(begins)]
    held = _held([AT_THE_CORNER], LAST_RESORT + 2.0, [across], crossings=crossings, step=SOUGHT_EVERY)
    statuses = [plan.status for plan in held]
    assert (WAY_OUT in statuses[: int(LAST_RESORT / SOUGHT_EVERY)]) == soon
    assert statuses[-1] == WAY_OUT


@pytest.mark.parametrize(
    ("lights", "walkers", "patience"),
    [
        ([PASSED], [], A_CYCLE),
        ([PASSED], [AT_THE_CORNER], PATIENCE),
        ([AHEAD], [], PATIENCE),
        ([], [], PATIENCE),
    ],
)
def test_in_a_junction_with_lights_vehicles_are_waited_for_longer(
    lights: Sequence[Signal], walkers: Sequence[Walker], patience: float
) -> None:
    """They wait for the lights to change; who goes round them comes into the way of those who have green."""
    nose = Car(BODY.front + 6.5, 1.6, heading_error=-2.6)
    held = _held(walkers, patience + 1.0, [nose], signals=lights, step=SOUGHT_EVERY)
    statuses = [plan.status for plan in held]
    assert WAY_OUT not in statuses[: int(patience / SOUGHT_EVERY)]
    assert statuses[-1] == WAY_OUT


def test_who_was_held_once_and_then_let_go_waits_anew() -> None:
    """Somebody at the corner for a moment, nobody for 10 s, then somebody again."""
    check, statuses = LastCheck(), []
    for tick in range(int(10 * (10.0 + PATIENCE)) + 10):
        walkers = [AT_THE_CORNER] if tick == 0 or tick >= 100 else [Walker(BODY.front + 4.0, -4.0)]
        seen = perception(ego(speed=0.0, time=0.1 * tick), straight_road(2), walkers)
        statuses.append(check.checked(seen, keeps(2.0), np.zeros(1, bool), None, Reach(False, 60.0)).status)
    assert statuses[0] == SHIELDED
    assert set(statuses[1:100]) == {"ok"}
    assert set(statuses[100 : 100 + int(10 * PATIENCE)]) == {SHIELDED}
    assert statuses[-1] == WAY_OUT


@pytest.mark.long
def test_the_last_resort_counts_all_the_time_held_since_the_ego_was_under_way() -> None:
    """People who cross ahead of it in between only make it wait for them, and then it is held again."""
    check, statuses = LastCheck(), []
    for tick in range(int(10 * LAST_RESORT) + 40):
        places = [(BODY.front + 4.0, -4.0)] if 100 <= tick < 120 else ROW
        seen = perception(ego(speed=0.0, time=0.1 * tick), straight_road(2), [Walker(*one) for one in places])
        held = len(places) > 1
        statuses.append(
            check.checked(seen, keeps(2.0), np.zeros(len(places), bool), None, Reach(held)).status
        )
    assert set(statuses[100:120]) == {"ok"}
    assert WAY_OUT not in statuses[: int(10 * LAST_RESORT) + 15]
    assert statuses[-1] == WAY_OUT


def test_a_way_is_not_given_up_at_its_beginning_because_the_plan_seems_free_for_a_moment() -> None:
    """Such a plan only creeps up to who keeps the ego from starting; if it stays free, it is followed."""
    check, statuses = LastCheck(), []
    for tick in range(int(10 * PATIENCE) + 30):
        plan = keeps(2.0 if tick < 10 * PATIENCE + 10 else 0.0)
        seen = perception(ego(speed=0.0, time=0.1 * tick), straight_road(2), [AT_THE_CORNER])
        statuses.append(check.checked(seen, plan, np.zeros(1, bool)).status)
    free = int(10 * PATIENCE) + 10
    assert set(statuses[free - 1 : free + int(10 * LET_GO) - 1]) == {WAY_OUT}
    assert statuses[-1] == "ok"


@pytest.mark.parametrize(("to_people", "status"), [(2.0, WAY_OUT), (np.inf, "ok")])
def test_a_way_is_driven_to_its_end_if_the_plan_would_end_before(to_people: float, status: str) -> None:
    """Back in its lane, the ego drove up to the people whom the way leads past, and stood on the crossing."""
    check, beyond = LastCheck(), Walker(BODY.front + 5.0, -1.5)
    for tick in range(int(10 * PATIENCE) + 40):
        taken = tick > 10 * PATIENCE + 5
        seen = perception(ego(speed=0.7 * taken, time=0.1 * tick), straight_road(2), [beyond])
        held = Reach(to_people=to_people) if taken else Reach(stuck=True)
        plan = check.checked(seen, keeps(0.7), np.zeros(1, bool), None, held)
    assert plan.status == status


@pytest.mark.parametrize(("apart", "status"), [(0.6, WAY_OUT), (1.2, "ok")])
def test_a_way_is_driven_until_nobody_stands_beside_the_ego(apart: float, status: str) -> None:
    """A plan that touched nobody for some seconds then turned back to the lane through those beside it."""
    check, beside = LastCheck(), Walker(1.5, -0.5 * BODY.width - 0.25 - apart)
    for tick in range(int(10 * PATIENCE) + 40):
        taken = tick > 10 * PATIENCE + 5
        seen = perception(ego(speed=0.7 * taken, time=0.1 * tick), straight_road(2), [beside])
        plan = check.checked(seen, keeps(0.7), np.zeros(1, bool), None, Reach(stuck=not taken))
    assert plan.status == status


def test_who_waits_for_a_light_or_a_leader_takes_none() -> None:
    assert _held([AT_THE_CORNER], PATIENCE + 1.0, room=3.0)[-1].status == SHIELDED


def test_vehicles_that_stand_are_gone_round_too_or_waited_for() -> None:
    beside = Car(BODY.front + 3.0, 3.2, length=6.0)
    assert _held([AT_THE_CORNER], PATIENCE + 1.0, [beside])[-1].status == WAY_OUT
    near = Car(BODY.front + 3.0, 2.0, length=6.0)
    assert _held([AT_THE_CORNER], PATIENCE + 1.0, [near])[-1].status == SHIELDED


@pytest.mark.parametrize("ahead", [4.0, 6.5])
def test_a_vehicle_that_stands_across_the_lane_before_a_crossing_is_gone_round(ahead: float) -> None:
    """It may wait for the ego: neither the room left to it nor the crossing behind it keeps the ego there."""
    nose = Car(BODY.front + ahead, 1.6, heading_error=-2.6)
    driver = catalog.build("vo_mpc")
    status = ""
    for tick in range(int(10 * PATIENCE) + 10):
        seen = perception(
            ego(speed=0.0, time=0.1 * tick),
            straight_road(2),
            cars=[nose],
            crossings=[zebra(BODY.front + 7.0)],
        )
        status = driver.plan(seen, driver.decide(seen)).status
    assert status == WAY_OUT


@pytest.mark.long
def test_a_queue_is_waited_in_although_the_ego_makes_room_for_somebody_in_its_lane() -> None:
    """Vehicles queue about the lane's centre line, not about the path that the ego has shifted."""
    queue, aside = Car(9.0, 0.0, length=2.0, width=0.7), Walker(4.6, -0.6)
    driver, statuses = catalog.build("vo_mpc"), set()
    for tick in range(int(10 * LAST_RESORT)):
        state = ego(speed=0.0, time=0.1 * tick)
        seen = perception(state, straight_road(1), [aside], [queue], crossings=[zebra(20.0)])
        statuses.add(driver.plan(seen, driver.decide(seen)).status)
    assert WAY_OUT not in statuses


@pytest.mark.parametrize(
    "people",
    [
        [Walker(1.0, -(0.5 * BODY.width + 0.25) + 0.05)],
        # SUMO's people walk into a standing car. However it moves, one of these gets farther under it.
        [Walker(2.0, 0.7), Walker(2.0, -0.7), Walker(3.0, 0.2), Walker(3.3, -0.2)],
        # The way leads off to the right of this one, but at first the bumper gets farther over them.
        [Walker(BODY.front - 0.2, 0.3)],
    ],
)
def test_people_who_lean_on_the_car_are_left_so_slowly_that_it_counts_as_standing(
    people: list[Walker],
) -> None:
    check, speed, steering = LastCheck(), 0.0, 0.0
    for tick in range(80):
        state = ego(speed=speed, time=0.1 * tick, steering=steering)
        seen = perception(state, straight_road(2), people)
        plan = check.checked(seen, keeps(2.0), np.full(len(people), False), None, Reach(True))
        speed = max(speed + 0.1 * float(plan.command.acceleration[0]), 0.0)
        steering = float(plan.command.steering[0])
        assert speed < INCHING + 1e-6
    assert plan.status == WAY_OUT
    assert speed > 0.5 * INCHING


@pytest.mark.parametrize(
    ("ahead", "to_stop", "inches"),
    [(1.0, np.inf, True), (0.1, np.inf, False), (1.0, 1.0, False)],
)
def test_whoever_is_leant_on_inches_off_while_others_cross_well_ahead(
    ahead: float, to_stop: float, inches: bool
) -> None:
    """While it stayed for everybody who crossed, more people gathered at its side."""
    leans = Walker(1.0, -0.5 * BODY.width - 0.25)
    crosses = Walker(BODY.front + ahead + 0.25, -0.5, 0.0, 1.3, 0, True)
    check, steering, moves = LastCheck(), 0.0, []
    for tick in range(int(10 * PATIENCE) + 20):
        state = ego(speed=0.0, time=0.1 * tick, steering=steering)
        seen = perception(state, straight_road(2), [leans, crosses])
        enters = np.array([False, True])
        plan = check.checked(seen, keeps(0.0), enters, None, Reach(False, ahead, to_stop))
        moves.append(plan.status == WAY_OUT and plan.command.acceleration[0] > 0.0)
        if plan.status == WAY_OUT:
            steering = float(plan.command.steering[0])
    assert not any(moves[: int(10 * PATIENCE)])
    assert moves[-1] == inches


@pytest.mark.parametrize(
    ("along", "across", "speed", "inches"),
    [
        (BODY.front + 2.5, -7.0, 5.0, True),  # they have passed long before the ego gets there
        (BODY.front + 1.2, -7.0, 5.0, False),
        (-3.0, -7.0, 3.0, True),  # they would hit the ego where it stands
    ],
)
def test_whoever_is_over_somebody_inches_off_while_vehicles_drive_past(
    along: float, across: float, speed: float, inches: bool
) -> None:
    """At a busy junction, one of them was always to be somewhere on the way in the next 3 s."""
    turn = 0.5 * np.pi if along > 0.0 else np.arctan2(-across, 4.0)
    car = Car(along, across, speed * np.cos(turn), speed * np.sin(turn), heading_error=turn)
    plans = _held([Walker(1.0, -0.3)], PATIENCE + 1.0, [car])
    assert (plans[-1].status == WAY_OUT) == inches


def test_on_the_way_people_beside_the_body_are_passed_slowly() -> None:
    """They step out as soon as the front is past, and are at the car within a quarter of a second."""
    beside = Walker(1.0, -0.5 * BODY.width - 0.25 - 0.5 * CLOSE, crossing=0, waiting=True)
    check, speed, steering, fastest = LastCheck(), 0.0, 0.0, 0.0
    for tick in range(int(10 * PATIENCE) + 60):
        seen = perception(ego(speed=speed, time=0.1 * tick, steering=steering), straight_road(2), [beside])
        plan = check.checked(seen, keeps(2.0), np.zeros(1, bool), None, Reach(True))
        if plan.status == WAY_OUT:
            speed = max(speed + 0.1 * float(plan.command.acceleration[0]), 0.0)
            steering = float(plan.command.steering[0])
            fastest = max(fastest, speed)
    assert 0.5 * PAST < fastest < PAST + 1e-6


@pytest.mark.long
def test_in_closed_loop_it_gets_past_somebody_who_will_not_move() -> None:
    """A person stands a metre ahead of the right corner of an ego that starts from a standstill."""
    record = ride(ToyRoad(), [walk(BODY.front + 0.9, -1.05, 0.0, 0.0)], speed=0.0, duration=60.0)
    ways_out = [i for i, plan in enumerate(record.plans) if plan.status == WAY_OUT]
    assert ways_out
    assert max(record.snapshots[i].egos[0].speed for i in ways_out) < SPEED + 0.3
    assert record.clearance() > 0.0
    assert record.arrival(20.0) < 40.0


@pytest.mark.long
def test_in_closed_loop_somebody_at_the_corner_is_brushed_after_a_minute_and_no_deeper() -> None:
    """They stand 2 cm before the right corner, where the sharpest turn to the left still reaches them."""
    at_the_corner = walk(BODY.front + 0.25, -0.5 * BODY.width - 0.09, 0.0, 0.0)
    record = ride(ToyRoad(), [at_the_corner], speed=0.0, duration=75.0)
    x, _, speed, _ = record.track
    waited = np.array([snapshot.time for snapshot in record.snapshots]) < BRUSHING
    assert x[waited].max() < x[0] + 0.02
    assert speed[x < x[0] + 0.2].max() < Thresholds().standing_speed_mps
    assert -BRUSHED - DRIFT < record.clearance() < 0.0
    assert x[-1] > x[0] + 3.0
