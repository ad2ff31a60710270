"""Signals and vehicles whose path crosses the ego's."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from controllers import catalog
from controllers.driving.right_of_way import (
    HARD_SHARE,
    LEAST_PAST,
    NOSE,
    PATIENCE,
    PATIENCE_INSIDE,
    REACTION,
    SETS_OFF,
    RightOfWay,
    StopPlace,
    must_stop,
    travel_time,
)
from controllers.interface import EgoState, JunctionFoe, Perception, Signal, SignalState, StopSign
from tests.controllers.drives import drive
from tests.controllers.scenes import Car, ego, perception, zebra


def _foe(distance: float, speed: float, must_yield: bool = True, length: float = 5.0) -> JunctionFoe:
    """Return a foe before a conflict 5 m long, at 26 m for the ego, whose stop line is at 20 m."""
    return JunctionFoe("foe", 26.0, 31.0, 20.0, distance, distance + 5.0 + length, speed, must_yield)


def _stops(seen: Perception) -> list[StopPlace]:
    return RightOfWay(1.8).stops(seen)


@pytest.mark.parametrize(
    ("state", "line", "stops"),
    [
        (SignalState.GREEN, 40.0, False),
        (SignalState.RED, 40.0, True),
        (SignalState.RED, 9.0, False),
        (SignalState.RED, -5.0, False),
        (SignalState.AMBER, 40.0, True),
        (SignalState.AMBER, 20.0, False),
    ],
)
def test_a_light_is_stopped_at_where_that_is_possible(state: SignalState, line: float, stops: bool) -> None:
    assert must_stop(Signal("tl", line, state), ego(12.0)) is stops


def test_a_standing_car_a_little_over_the_line_stays_at_red() -> None:
    assert must_stop(Signal("tl", 3.0, SignalState.RED), ego(0.0))


def _at_a_sign(speed: float, line: float) -> Perception:
    seen = perception(ego(speed))
    return replace(seen, road=replace(seen.road, stop_signs=(StopSign("sign", line),)))


def test_at_a_stop_sign_the_ego_stops_once_and_then_drives_on() -> None:
    way = RightOfWay(1.8)
    assert way.stops(_at_a_sign(8.0, 30.0)) == [StopPlace("sign", 30.0)]
    assert way.stops(_at_a_sign(0.0, 12.0)) == [StopPlace("sign", 12.0)], "it stands in the queue before it"
    assert way.stops(_at_a_sign(2.5, 6.0)) == [StopPlace("sign", 6.0)]
    assert way.stops(_at_a_sign(0.1, 4.5)) == []
    assert way.stops(_at_a_sign(1.0, 4.4)) == [], "it sets off"
    assert way.stops(perception(ego(8.0))) == []
    assert way.stops(_at_a_sign(8.0, 30.0)) == [StopPlace("sign", 30.0)], "of the next round"


def test_who_is_slow_near_a_stop_sign_stops_at_once() -> None:
    (stop,) = RightOfWay(1.8).stops(_at_a_sign(1.0, 7.0))
    assert 4.0 < stop.along < 5.5, "not at the line, which would take it seconds"
    assert RightOfWay(1.8).stops(_at_a_sign(3.0, 7.0)) == [StopPlace("sign", 7.0)]


def test_a_stop_sign_that_comes_too_late_is_passed() -> None:
    assert RightOfWay(1.8).stops(_at_a_sign(10.0, 6.0)) == []


def test_a_foe_that_arrives_with_the_ego_is_yielded_to_at_the_stop_line() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(25.0, 10.0)])) == [StopPlace("foe", 20.0)]


def test_a_foe_that_must_yield_itself_is_not_yielded_to() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(25.0, 10.0, must_yield=False)])) == []


def test_a_foe_that_must_yield_and_drives_off_all_the_same_is_yielded_to() -> None:
    """It stood inside the junction, drove off while the ego slowed down for somebody else, and was struck."""
    rule = RightOfWay(1.8)
    speeds, stops = (1.0, 1.3, 1.6, 3.0), []
    for i, speed in enumerate(speeds):
        foe = _foe(6.0 - 0.1 * sum(speeds[:i]), speed, must_yield=False)
        stops.append(rule.stops(perception(ego(9.0, time=0.1 * i), foes=[foe])))
    assert stops[0] == [], "it has been seen once"
    assert stops[1] == [], "it could stop at once"
    assert stops[3] == [StopPlace("foe", 20.0)]
    slower = _foe(5.3, 2.9, must_yield=False)
    assert rule.stops(perception(ego(9.0, time=0.4), foes=[slower])) == [], "it brakes"


def test_a_foe_that_speeds_up_is_yielded_to_however_often_one_asks_in_a_step() -> None:
    rule = RightOfWay(1.8)
    for i, speed in enumerate((1.0, 3.0)):
        foe = _foe(6.0 - 0.1 * i, speed, must_yield=False)
        scene = perception(ego(9.0, time=0.1 * i), foes=[foe])
        asked = [rule.stops(scene) for _ in range(3)]
    assert asked == [[StopPlace("foe", 20.0)]] * 3


def test_a_foe_that_must_yield_and_cannot_stop_any_more_is_yielded_to() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(12.0, 10.0, must_yield=False)])) == [StopPlace("foe", 20.0)]


def test_a_foe_that_comes_much_later_is_not_waited_for() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(120.0, 10.0)])) == []


def test_a_foe_that_has_left_is_not_waited_for() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(-11.0, 10.0)])) == []


def test_a_foe_that_leaves_before_the_ego_enters_is_not_waited_for() -> None:
    assert _stops(perception(ego(2.0), foes=[_foe(-2.0, 10.0)])) == []


def test_a_bus_that_is_still_in_the_conflict_with_its_rear_is_waited_for() -> None:
    assert _stops(perception(ego(8.0), foes=[_foe(-11.0, 3.0, length=4.5)])) == []
    assert _stops(perception(ego(8.0), foes=[_foe(-11.0, 3.0, length=18.0)])) == [StopPlace("foe", 20.0)]


def test_a_foe_that_stands_in_the_conflict_is_never_driven_into() -> None:
    standing = replace(_foe(-1.0, 0.0), must_yield=False)
    assert _stops(perception(ego(8.0), foes=[standing])) == [StopPlace("foe", 20.0)]


def test_past_the_stop_line_the_conflict_itself_is_kept_free() -> None:
    seen = perception(ego(3.0), foes=[replace(_foe(12.0, 10.0), stop_line=1.0, entry=9.0, exit=14.0)])
    assert _stops(seen) == [StopPlace("foe", 8.0)]


def test_past_the_stop_line_the_ego_waits_where_others_wait_in_that_junction() -> None:
    foe = replace(_foe(12.0, 10.0), stop_line=1.0, entry=14.0, exit=19.0)
    for waiting_place, stop in ((9.0, 9.0), (13.5, 13.0), (2.0, 13.0)):
        seen = perception(ego(4.0), foes=[replace(foe, waiting_place=waiting_place)])
        assert _stops(seen) == [StopPlace("foe", stop)], waiting_place


@pytest.mark.parametrize(
    ("changed", "stop"),
    [
        ({}, 24.0),
        ({"signals": []}, 20.0),
        ({"signals": [Signal("tl", 20.0, SignalState.AMBER)]}, 20.0),
        ({"signals": [Signal("beyond", 50.0, SignalState.GREEN)]}, 20.0),
        ({"waiting_place": 25.5}, 20.0),
        ({"cars": [Car(along=28.0, across=0.0)]}, 20.0),
        ({"cars": [Car(along=34.0, across=0.0)]}, 24.0),
        ({"crossings": [zebra(16.5)]}, 20.0),
        ({"crossings": [zebra(14.5)]}, 24.0),
    ],
)
def test_at_a_green_light_the_first_waits_inside_the_junction(changed: dict[str, Any], stop: float) -> None:
    """Only where the junction has a place before the conflict, and no crossing is behind it."""
    seen: dict[str, Any] = {
        "signals": [Signal("tl", 20.0, SignalState.GREEN)],
        "waiting_place": 24.0,
    } | changed
    foe = replace(_foe(30.0, 10.0), waiting_place=seen.pop("waiting_place"))
    assert StopPlace("foe", stop) in _stops(perception(ego(8.0), foes=[foe], **seen))


def test_an_ego_in_the_conflict_clears_it() -> None:
    seen = perception(ego(3.0), foes=[replace(_foe(12.0, 10.0), stop_line=-5.0, entry=2.0, exit=8.0)])
    assert _stops(seen) == []


def test_an_ego_that_cannot_stop_any_more_drives_on() -> None:
    seen = perception(ego(13.0), foes=[replace(_foe(20.0, 10.0), stop_line=5.0, entry=8.0, exit=13.0)])
    assert _stops(seen) == []


def test_an_ego_that_cannot_stop_any_more_brakes_for_a_foe_that_it_would_hit() -> None:
    """The foe turned before the ego, which had slowed down for somebody else, and the ego drove into it."""
    near = replace(_foe(3.0, 5.0, must_yield=False), stop_line=-5.0, entry=8.0, exit=13.0)
    rule = RightOfWay(1.8)
    assert rule.stops(perception(ego(8.3), foes=[near])) == [StopPlace("foe", 7.0)]
    assert rule.firm_line == 7.0, "it brakes as hard as it can"
    creeps = replace(_foe(3.0, 1.4), stop_line=-5.0, entry=8.0, exit=13.0)
    assert _stops(perception(ego(8.3), foes=[creeps])) == [], "it is not there in time"
    gone_by_then = replace(near, foe_entry=-7.0, foe_exit=1.0)
    assert _stops(perception(ego(8.3), foes=[gone_by_then])) == []


def test_an_ego_that_stands_close_before_the_conflict_stays_there() -> None:
    seen = perception(ego(0.0), foes=[replace(_foe(12.0, 10.0), stop_line=-5.0, entry=4.2, exit=9.0)])
    assert _stops(seen) == [StopPlace("foe", 3.2)]


def test_a_foe_that_keeps_standing_is_waited_for_with_patience_only() -> None:
    rule = RightOfWay(1.8)
    standing = _foe(6.0, 0.0)
    assert rule.stops(perception(ego(0.0, time=0.0), foes=[standing])) != []
    assert rule.stops(perception(ego(0.0, time=PATIENCE - 0.1), foes=[standing])) != []
    assert rule.stops(perception(ego(0.0, time=PATIENCE), foes=[standing])) == []
    assert rule.stops(perception(ego(0.0, time=PATIENCE + 0.1), foes=[_foe(6.0, 1.0)])) != []


def test_one_that_stands_with_its_nose_in_the_conflict_is_waited_for_longer() -> None:
    rule = RightOfWay(1.8)
    inside = _foe(-0.5, 0.0)
    assert PATIENCE_INSIDE > PATIENCE
    for time in (0.0, PATIENCE + 0.1, PATIENCE_INSIDE - 0.1):
        assert rule.stops(perception(ego(0.0, time=time), foes=[inside])) != []
    assert rule.stops(perception(ego(0.0, time=PATIENCE_INSIDE), foes=[inside])) == []
    assert rule.stops(perception(ego(0.0, time=PATIENCE_INSIDE + 0.1), foes=[_foe(-0.5, 1.0)])) != []


@pytest.mark.parametrize(("nose", "patience"), [(0.03, PATIENCE), (1.0, PATIENCE), (-0.5, PATIENCE_INSIDE)])
def test_a_foe_that_lets_the_ego_go_first_is_passed_before_it_is_in_the_way_or_stopped_for(
    nose: float, patience: float
) -> None:
    rule, standing = RightOfWay(1.8), _foe(nose, 0.0)
    for time in (0.0, patience - 0.1, patience):
        rule.stops(perception(ego(0.0, time=time), foes=[standing]))
        found = rule.passed(perception(ego(0.0, time=time), foes=[standing]))
        assert bool(found) == (time == patience)
    (foe,) = found
    assert foe.along == pytest.approx(26.0)
    speed = foe.speed
    hardest = HARD_SHARE * ego().drive.max_deceleration
    arrives = np.sqrt(2.0 * (max(nose, 0.0) + NOSE) / SETS_OFF)
    for gap in np.linspace(0.1, 20.0, 100):
        stops = gap >= speed * REACTION + speed**2 / (2.0 * hardest)
        assert stops or gap / speed <= arrives or speed == LEAST_PAST


def test_foes_that_drive_that_yield_or_that_have_been_met_do_not_slow_the_ego_down() -> None:
    for foe in (_foe(0.03, 1.0), _foe(0.03, 0.0, must_yield=False), replace(_foe(0.03, 0.0), entry=2.0)):
        rule = RightOfWay(1.8)
        for time in (0.0, PATIENCE_INSIDE):
            rule.stops(perception(ego(0.0, time=time), foes=[foe]))
        assert rule.passed(perception(ego(0.0, time=PATIENCE_INSIDE), foes=[foe])) == []


@pytest.mark.parametrize("controller", ["vo_mpc", "aeb", "trapezoid"])
@pytest.mark.parametrize(("nose", "slowly"), [(0.03, True), (6.0, False)])
def test_an_ego_passes_slowly_where_a_foe_stands_with_its_nose_before_its_way(
    nose: float, slowly: bool, controller: str
) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        place = 70.0 - travelled
        foe = JunctionFoe("foe", place, place + 5.0, place - 6.0, nose, nose + 10.0, 0.0, True)
        return perception(state, foes=[foe])

    driven = drive(catalog.build(controller), scene, 6.0, 18.0)
    at = int(np.argmax(driven[:, 1] + ego().body.front > 70.0))
    assert at > 0, "it does not wait for ever"
    assert (driven[at, 3] < LEAST_PAST + 0.4) == slowly


def test_travel_time_speeds_up_and_then_keeps_the_limit() -> None:
    # 4 s from 0 to 8 m/s take 16 m, the other 16 m take 2 s.
    assert travel_time(32.0, 0.0, 2.0, 8.0) == pytest.approx(6.0)
    assert travel_time(-1.0, 5.0, 2.0, 8.0) == 0.0


@pytest.mark.parametrize(("distance", "stops"), [(60.0, True), (75.0, False)])
def test_a_bend_ahead_slows_the_ego_down_in_the_bend_alone(distance: float, stops: bool) -> None:
    """From 12 m/s it is 3.2 m/s in a bend of 4 m from 25 m on, and out of the conflict after 5.9 s."""
    seen = perception(ego(12.0))
    places = np.arange(0.0, 60.0, 0.5)
    road = replace(
        seen.road,
        curvature=np.where(places < 25.0, 0.0, 0.25),
        curvature_step=0.5,
        foes=(_foe(distance, 10.0),),
    )
    assert bool(_stops(replace(seen, road=road))) is stops


@pytest.mark.parametrize(("limit", "stops"), [(13.89, False), (2.0, True)])
def test_a_low_limit_on_the_way_makes_the_ego_take_longer(limit: float, stops: bool) -> None:
    """The foe is there after 5.5 s; at 2 m/s from 20 m on, the ego needs as long for the 11 m of conflict."""
    seen = perception(ego(8.0))
    road = replace(
        seen.road,
        limit_along=np.array([-100.0, 20.0, 32.0]),
        limit=np.array([13.89, limit, 13.89]),
        foes=(_foe(55.0, 10.0),),
    )
    assert bool(_stops(replace(seen, road=road))) is stops


def test_without_any_known_bend_the_way_to_the_conflict_still_takes_its_time() -> None:
    seen = perception(ego(10.0), foes=[_foe(30.0, 10.0)])
    seen = replace(seen, road=replace(seen.road, curvature=np.zeros(0)))
    assert _stops(seen) == [StopPlace("foe", 20.0)]
