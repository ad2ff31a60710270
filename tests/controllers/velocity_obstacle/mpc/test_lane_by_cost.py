"""Where an ego waits for a change of lane that its route asks for."""

from __future__ import annotations

import math

import pytest

from controllers import catalog
from controllers.interface import Body, Crossing, Manoeuvre, Signal, SignalState
from controllers.velocity_obstacle.mpc.driver import VelocityObstacleMpc
from controllers.velocity_obstacle.mpc.lane_by_cost import LaneByCost
from tests.controllers.scenes import Car, Walker, ego, lanes_that_follow, perception, straight_road, zebra

ENDS = 60.0


def _place(
    reference: int, speed: float = 5.0, ends: float = ENDS, crossings: tuple[Crossing, ...] = ()
) -> float:
    driver = catalog.build("vo_mpc", seed=1)
    assert isinstance(driver, VelocityObstacleMpc)
    settings = driver.settings.change
    road = lanes_that_follow(straight_road(2, reference), {reference: ends})
    return LaneByCost(settings, driver._lanes).waiting_place(
        perception(ego(speed=speed), road, crossings=crossings)
    )


def test_of_two_side_by_side_who_want_each_others_lane_the_left_one_waits_behind_the_other() -> None:
    to_the_left, to_the_right = _place(0), _place(1)
    assert to_the_left < ENDS
    assert to_the_left - to_the_right > Body().length + 2.5


def test_who_cannot_stop_there_waits_nearer_to_the_end_or_nowhere() -> None:
    assert _place(1, speed=15.0, ends=45.0) == pytest.approx(_place(0, ends=45.0))
    assert math.isinf(_place(1, speed=25.0))


def test_where_a_crossing_is_in_the_way_of_the_change_it_waits_beyond_it_if_there_is_room() -> None:
    """Between the crossings of a short street; before the first one no change could ever begin."""
    free, first = _place(1, speed=1.0, ends=25.0), zebra(2.0)
    there = _place(1, speed=1.0, ends=25.0, crossings=(first, zebra(26.0)))
    assert free < first.exit + Body().length
    assert first.exit + Body().length < there < 26.0


def test_between_crossings_that_follow_each_other_closely_it_waits_with_its_body_on_none() -> None:
    first, second = zebra(2.0), zebra(16.0)
    between = _place(1, speed=1.0, ends=25.0, crossings=(first, second))
    assert first.exit + Body().length < between < second.entry
    assert _place(1, speed=1.0, ends=45.0, crossings=(zebra(22.0), zebra(32.0))) == 21.0


def test_it_changes_over_the_crossings_from_there_as_no_better_place_follows() -> None:
    """An ego stood before its waiting place between two crossings until it was given up."""
    controller = catalog.build("vo_mpc", seed=1)
    for forward, begins in ((0.0, False), (8.5, True)):
        near = (zebra(2.0 - forward), zebra(16.0 - forward))
        road = lanes_that_follow(straight_road(2, 1), {1: 25.0 - forward})
        seen = perception(ego(speed=0.0, time=forward), road, crossings=near)
        assert (controller.decide(seen).manoeuvre is Manoeuvre.CHANGE_RIGHT) is begins


def test_who_comes_to_rest_beyond_the_place_waits_where_it_can_still_change() -> None:
    """Having given up a change, an ego stood just beyond the place and drove on to the end of its lane."""
    front = Body().front
    assert _place(0, speed=0.0, ends=front + 10.0) == front
    assert front < _place(0, speed=2.0, ends=front + 10.0) <= front + 2.0
    assert math.isinf(_place(0, speed=0.0, ends=front + 5.0))
    on_one = tuple(zebra(front + far) for far in (-2.0, 8.0, 18.0))
    assert math.isinf(_place(0, speed=0.0, ends=front + 10.0, crossings=on_one))


def test_from_there_the_change_begins() -> None:
    controller = catalog.build("vo_mpc", seed=1)
    road = lanes_that_follow(straight_road(2, 1), {1: 25.0})
    before = perception(ego(speed=0.0), road, crossings=(zebra(2.0), zebra(26.0)))
    assert controller.decide(before).manoeuvre is Manoeuvre.KEEP
    there = perception(ego(speed=0.0, time=30.0), road, crossings=(zebra(-6.0), zebra(18.0)))
    assert controller.decide(there).manoeuvre is Manoeuvre.CHANGE_RIGHT


def test_an_ego_that_stands_a_little_before_its_waiting_place_sets_out() -> None:
    """A plan that is slow at first and fast at the end of its horizon would be planned anew for ever."""
    controller = catalog.build("vo_mpc", seed=1)
    road = lanes_that_follow(straight_road(2, 1), {1: 27.6})
    for instant in range(5):
        seen = perception(ego(speed=0.0, time=0.1 * instant), road, cars=[Car(3.0, -3.5)])
        plan = controller.plan(seen, controller.decide(seen))
    assert plan.command.acceleration[0] > 0.3
    assert plan.along[-1] < 4.0


@pytest.mark.parametrize(
    ("speed", "ends", "light", "there", "begins"),
    [
        (0.0, 5.0, None, (), True),
        (2.0, 5.0, None, (), False),
        (0.0, 25.0, None, (), False),
        (0.0, 5.0, SignalState.GREEN, (), True),
        (0.0, 5.0, SignalState.RED, (), False),
        (0.0, 5.0, SignalState.AMBER, (), False),
        (0.0, 5.0, None, (Walker(7.0, -2.0, across_speed=1.3, crossing=0, on_crossing=True),), False),
        (0.0, 5.0, None, (Walker(7.0, -6.0, crossing=0, waiting=True),), False),
    ],
)
def test_at_the_very_end_of_its_lane_an_ego_that_stands_changes_over_the_crossing(
    speed: float, ends: float, light: SignalState | None, there: tuple[Walker, ...], begins: bool
) -> None:
    """No better place comes; else it would wait for ever. It waits for whoever crosses, and for green."""
    controller = catalog.build("vo_mpc", seed=1)
    road = lanes_that_follow(straight_road(2, 1), {1: ends})
    signals = () if light is None else (Signal("s", ends, light),)
    seen = perception(ego(speed=speed), road, there, crossings=(zebra(7.0),), signals=signals)
    begun = controller.decide(seen).manoeuvre is Manoeuvre.CHANGE_RIGHT
    assert begun is begins


@pytest.mark.parametrize("name", ["vo_mpc", "aeb"])
def test_a_change_that_no_longer_serves_the_route_is_given_up(name: str) -> None:
    """The ego waited at the end of its lane, and got another route there, which its own lane follows."""
    controller = catalog.build(name, seed=1)
    end = {0: Body().front + 12.0, 1: math.inf}
    road = lanes_that_follow(straight_road(2, 0), end)
    first = perception(ego(speed=0.0), road)
    assert controller.decide(first).manoeuvre is Manoeuvre.CHANGE_LEFT
    anew = lanes_that_follow(straight_road(2, 0), {0: math.inf, 1: Body().front + 0.5})
    for tick in range(1, 4):
        seen = perception(ego(speed=0.0, time=0.1 * tick), anew)
        decision = controller.decide(seen)
        plan = controller.plan(seen, decision)
    assert decision.manoeuvre is Manoeuvre.KEEP
    assert plan.command.acceleration[-1] > 0.5, "it drives on"
