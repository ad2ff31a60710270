"""Planning less often on an empty road, and at every step as soon as somebody is near."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from controllers import catalog
from controllers.interface import Manoeuvre, Perception, Signal, SignalState, StopSign
from controllers.velocity_obstacle.mpc.idle_planning import Unhurried
from cosim.step.toy_road import Motion, ToyCrossing, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from tests.controllers.scenes import ego, perception, straight_road
from tests.controllers.toy_runs import Ride, ride


def _planned(record: Ride) -> int:
    """Return how many plans were made; a rest has no horizon."""
    return sum(len(plan.times) > 0 for plan in record.plans)


def test_on_an_empty_road_every_fifth_step_is_planned_and_the_ego_drives_almost_the_same() -> None:
    often = ride(ToyRoad(), speed=5.0, duration=10.0)
    seldom = ride(ToyRoad(), speed=5.0, duration=10.0, parameters={"idle_interval_s": 0.5})
    assert _planned(often) == len(often.plans)
    assert _planned(seldom) == pytest.approx(len(often.plans) / 5, abs=2)
    # Measured: 0.2 m behind after 112 m, while it speeds up from 5 to 13.9 m/s.
    assert np.abs(seldom.track[0] - often.track[0]).max() < 0.3
    assert np.abs(seldom.track[2] - often.track[2]).max() < 0.1


def test_while_somebody_is_at_a_crossing_in_view_nothing_changes() -> None:
    road, people = ToyRoad(crossings=(ToyCrossing(60.0),)), [walk(62.0, -6.0, 0.0, 1.3)]
    often = ride(road, people, duration=8.0)
    seldom = ride(road, people, duration=8.0, parameters={"idle_interval_s": 0.5})
    across = np.array([snapshot.persons.y[0] for snapshot in often.snapshots])
    before = across < 2.0  # still in front of the ego, which waits for them
    assert before.sum() > 40
    assert np.array_equal(seldom.track[:, before], often.track[:, before])


def test_a_crossing_with_nobody_at_it_is_no_reason_to_plan() -> None:
    road, people = ToyRoad(crossings=(ToyCrossing(60.0),)), [walk(20.0, -5.0, 1.3, 0.0)]
    record = ride(road, people, duration=4.0, parameters={"idle_interval_s": 0.5})
    assert _planned(record) == pytest.approx(len(record.plans) / 5, abs=2)


def _before_and_after(record: Ride, at: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which steps are planned until the ego is told of what happens at a time, and from then on."""
    planned = np.array([len(plan.times) > 0 for plan in record.plans])
    told = np.array([snapshot.time for snapshot in record.snapshots])[:-1] > at
    return planned[1:][~told], planned[1:][told]


@pytest.mark.parametrize("beside", [-4.0, 4.0])
def test_who_steps_onto_the_road_is_planned_for_from_that_step_on(beside: float) -> None:
    stepping = walk(70.0, beside, 0.0, -np.sign(beside) * 1.4, start=2.0)
    record = ride(ToyRoad(), [stepping], speed=8.0, duration=4.0, parameters={"idle_interval_s": 0.5})
    before, after = _before_and_after(record, 2.0)
    assert before.mean() < 0.4
    assert after.all()


def _cuts_in(time: float) -> tuple[float, float, float, float]:
    """Drive in the left lane, and from 2 s on into the right one."""
    moved = max(time - 2.0, 0.0)
    return 22.0 + 13.0 * time, 3.5 - moved, 13.0, -1.0 if moved > 0.0 else 0.0


@pytest.mark.parametrize("vehicle", [walk(100.0, 0.0, 13.0, 0.0, stop=2.0), _cuts_in])
def test_who_stops_ahead_and_who_cuts_in_are_planned_for_from_that_step_on(vehicle: Motion) -> None:
    road = ToyRoad(lanes=2)
    record = ride(road, vehicles=[vehicle], speed=13.0, duration=3.5, parameters={"idle_interval_s": 0.5})
    before, after = _before_and_after(record, 2.0)
    assert before.mean() < 0.4
    assert after.all()


def _lit(perception: Perception, state: SignalState, later: float = 0.0) -> Perception:
    """Return the perception with a light 60 m ahead, and so much later [s]."""
    ego = replace(perception.ego, time=perception.ego.time + later)
    road = replace(perception.road, signals=(Signal("light", 60.0, state),))
    return replace(perception, ego=ego, road=road)


@pytest.mark.parametrize(
    ("before", "now", "rests"),
    [
        (SignalState.RED, SignalState.RED, True),
        (SignalState.GREEN, SignalState.GREEN, True),
        (SignalState.GREEN, SignalState.RED, False),
        (SignalState.RED, SignalState.GREEN, False),
        (SignalState.AMBER, SignalState.AMBER, False),
    ],
)
def test_a_light_is_planned_for_when_it_changes_and_while_it_is_amber(
    before: SignalState, now: SignalState, rests: bool
) -> None:
    world = ToyWorld(ToyRoad(), [], [], speed=10.0, duration=1.0)
    perceptions = world.sense()
    assert perceptions
    driver = catalog.build("vo_mpc", idle_interval_s=0.5)
    for told in (_lit(perceptions[0], before), _lit(perceptions[0], now, later=0.1)):
        plan = driver.plan(told, driver.decide(told))
    assert (len(plan.times) == 0) == rests


def test_a_stop_sign_ahead_is_planned_for_at_every_step() -> None:
    world = ToyWorld(ToyRoad(), [], [], speed=10.0, duration=1.0)
    perceptions = world.sense()
    assert perceptions
    first = perceptions[0]
    told = replace(first, road=replace(first.road, stop_signs=(StopSign("sign", 60.0),)))
    later = replace(told, ego=replace(told.ego, time=told.ego.time + 0.1))
    driver = catalog.build("vo_mpc", idle_interval_s=0.5)
    plans = [driver.plan(one, driver.decide(one)) for one in (told, later)]
    assert all(len(plan.times) for plan in plans)


@pytest.mark.parametrize("interval", [-0.1, 0.6, float("nan")])
def test_an_interval_that_commands_do_not_last_for_is_refused(interval: float) -> None:
    with pytest.raises(ValueError, match="idle_interval_s"):
        catalog.build("vo_mpc", idle_interval_s=interval)


def test_a_change_on_request_is_begun_and_planned_at_once() -> None:
    driver = catalog.build("vo_mpc", idle_interval_s=0.5, lane_changes=False)
    assert isinstance(driver, Unhurried)
    seen = perception(ego(10.0), straight_road(2))
    driver.plan(seen, driver.decide(seen))
    later = replace(seen, ego=replace(seen.ego, time=0.1, x=1.0))
    assert driver.begin_change(later, 1)
    decision = driver.decide(later)
    assert decision.manoeuvre is Manoeuvre.CHANGE_LEFT
    assert len(driver.plan(later, decision).times)
