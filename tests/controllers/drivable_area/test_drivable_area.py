"""The drivable-area controller in closed loop, on the road without SUMO."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any, cast

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import Body, Decision, Perception, Plan
from cosim.pedestrians.line import Line
from cosim.pedestrians.manner import Pace
from cosim.pedestrians.start import AtTime
from cosim.pedestrians.steady import Steady
from cosim.pedestrians.swerving import Swerving
from cosim.pedestrians.walker import Walker as ScriptedWalker
from cosim.step.loop import run
from cosim.step.plant import CAR_DRIVE, Plant
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road, zebra
from tests.controllers.toy_runs import Ride, ride
from tests.cosim.pedestrians.toy_walk import ToyWalk

NARROW = ToyRoad(lanes=1, lane_width=3.5)
WIDE = ToyRoad(lanes=3, lane_width=3.5)


_ride = partial(ride, duration=10.0, controller="drivable_area")


def _answers(scenes: Sequence[Perception], **parameters: object) -> list[tuple[Decision, Plan]]:
    controller = catalog.build("drivable_area", **cast(Any, parameters))
    return [(decision := controller.decide(scene), controller.plan(scene, decision)) for scene in scenes]


def _later(scene: Perception, count: int, interval: float = 0.1) -> list[Perception]:
    return [replace(scene, ego=replace(scene.ego, time=index * interval)) for index in range(count)]


def test_without_pedestrians_it_drives_as_a_driver_without_them_does() -> None:
    leader = walk(60.0, 0.0, 6.0, 0.0)
    ours = _ride(WIDE, vehicles=[leader])
    other = _ride(WIDE, vehicles=[leader], controller="aeb")
    np.testing.assert_array_equal(ours.commands, other.commands)


@pytest.mark.long
@pytest.mark.parametrize(
    ("start", "distance"),
    [
        (-4.0, 45.0),
        (-2.5, 25.0),
        (4.0, 25.0),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in ((-6.0, 25.0), (-2.5, 45.0), (1.0, 45.0))),
    ],
)
def test_somebody_who_crosses_is_not_touched(start: float, distance: float) -> None:
    way = -1.0 if start > 0.0 else 1.0
    ride = _ride(NARROW, [walk(FRONT + distance, start, 0.0, 1.3 * way)])
    assert ride.clearance() > 0.25
    assert np.abs(ride.track[1]).max() < 0.9


BESIDE = walk(FRONT + 40.0, 3.5 - 1.5, 0.0, 0.0)
"""Stands 0.25 m beside the path of a car in lane 1, which would pass too near."""


def test_somebody_at_the_edge_of_the_way_is_driven_round_and_the_lane_taken_again() -> None:
    ride = _ride(WIDE, [BESIDE], speed=12.0, lane=1, duration=9.0)
    assert ride.clearance() > 0.6
    assert np.abs(ride.track[1] - 3.5).max() > 0.3
    assert ride.track[2].min() > 8.0
    assert ride.track[1, -1] == pytest.approx(3.5, abs=0.15)
    assert ride.plans[-1].overlay == {}


@pytest.mark.long
def test_to_the_weights_of_the_paper_standing_still_is_best() -> None:
    ride = _ride(WIDE, [BESIDE], speed=12.0, lane=1, duration=9.0, parameters={"progress_weight": 0.0})
    assert ride.clearance() > 0.6
    assert ride.track[2].min() < 0.5


@pytest.mark.long
def test_where_no_candidate_stops_in_time_full_braking_still_may() -> None:
    late = walk(FRONT + 13.0, 3.5 - 1.2, 0.0, 0.4)
    ride = _ride(WIDE, [late], speed=12.0, lane=1, duration=6.0)
    braked = _ride(WIDE, [late], speed=12.0, lane=1, duration=6.0, controller="aeb")
    assert {plan.status for plan in ride.plans[:10]} == {"no_feasible_candidate"}
    assert braked.clearance() < 0.0 < ride.clearance()


@pytest.mark.long
def test_beside_traffic_it_does_not_swerve_into_it() -> None:
    left = [walk(x, 7.0, 12.0, 0.0) for x in (-12.0, -3.0, 6.0, 15.0, 24.0)]
    free, hemmed = (_ride(WIDE, [BESIDE], cars, speed=12.0, lane=1, duration=6.0) for cars in ([], left))
    assert free.track[1].max() > 3.8
    assert hemmed.distance_to_vehicles() > 0.3
    assert hemmed.clearance() > 0.3


@pytest.mark.long
def test_it_stays_on_the_road() -> None:
    late = walk(FRONT + 12.0, 1.0, 0.0, -0.3)
    ride = _ride(NARROW, [late], speed=11.0, duration=6.0)
    assert np.abs(ride.track[1]).max() + 0.9 < 1.75


@pytest.mark.slow
def test_a_crowd_on_a_zebra_is_not_touched() -> None:
    drawn = np.random.default_rng(5)
    crowd = [
        walk(float(50.0 + drawn.uniform(0.0, 4.0)), float(side * drawn.uniform(3.0, 12.0)), 0.0, -1.3 * side)
        for side in drawn.choice([-1.0, 1.0], 12)
    ]
    road = replace(NARROW, crossings=(ToyCrossing(50.0),))
    ride = _ride(road, crowd, duration=18.0)
    assert ride.clearance() > 0.25
    assert ride.track[0, -1] > 60.0


@pytest.mark.long
def test_with_pedestrians_and_traffic_on_several_lanes_nobody_is_touched() -> None:
    crowd = [walk(45.0 + 12.0 * i, -4.0 - i, 0.0, 1.2) for i in range(5)]
    vehicles = [walk(30.0, 3.5, 9.0, 0.0), walk(-15.0, 3.5, 11.0, 0.0), walk(25.0, 0.0, 9.0, 0.0)]
    ride = _ride(WIDE, crowd, vehicles, speed=11.0, duration=14.0)
    assert ride.clearance() > 0.25
    assert ride.distance_to_vehicles() > 0.2


@pytest.mark.long
def test_walkers_who_keep_off_by_social_force_are_not_touched_either() -> None:
    ego = Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, 12.0)
    crowd = []
    for i in range(4):
        line = Line(45.0 + 10.0 * i, -3.0 - i, 45.0 + 10.0 * i, 40.0)
        walker = ScriptedWalker(line, Pace(1.25), Steady(), AtTime(0.0), line.length)
        crowd.append(ToyWalk(Swerving(walker, seed=i), ego))
    ride = _ride(NARROW, crowd, duration=14.0)
    assert ride.clearance() > 0.25


@pytest.mark.long
def test_nobody_standing_beside_the_lane_holds_it_up_for_ever() -> None:
    ride = _ride(WIDE, [walk(40.0, -2.2, 0.0, 0.0)], duration=20.0)
    assert ride.clearance() > 0.3
    assert ride.track[0, -1] > 100.0


def test_somebody_at_the_bumper_is_braked_for_fully_and_said_so() -> None:
    scene = perception(ego(8.0), straight_road(), [Walker(FRONT + 0.3, 0.0)])
    for decision, plan in _answers(_later(scene, 3)):
        assert not plan.solved
        assert plan.status == "no_feasible_candidate"
        assert plan.command.acceleration.max() <= -0.8 * 9.8
        assert decision.because == "person0"


def test_a_pedestrian_with_priority_who_waits_is_let_pass() -> None:
    scene = perception(
        ego(12.0),
        straight_road(),
        [Walker(50.0, -3.4, crossing=0, waiting=True)],
        crossings=[zebra(48.0)],
    )
    decision, plan = _answers([scene])[0]
    assert decision.because == "person0"
    assert plan.command.acceleration[-1] < -0.3
    assert plan.speed[-1] < 9.0


def test_a_course_is_kept_between_two_searches_and_a_search_looks_at_so_many_candidates() -> None:
    scene = perception(ego(9.0), straight_road(3, 1), [Walker(40.0, 0.3, 0.0, 0.1)])
    moving = []
    for index in range(25):
        shifted = 0.05 * 9.0 * index
        state = replace(scene.ego, time=0.05 * index, x=shifted, plan_interval=0.05)
        people = replace(scene.pedestrians, along=scene.pedestrians.along - shifted)
        moving.append(replace(scene, ego=state, pedestrians=people))
    plans = [plan for _, plan in _answers(moving)]
    assert {plan.status for plan in plans} == {"ok"}
    # The final offset in the world: the car drives straight on here, so it changes by a search alone.
    ends = [float(plan.overlay["path"][-1, 1]) for plan in plans]
    changed = np.flatnonzero(np.abs(np.diff(ends)) > 1e-9) + 1
    assert set(changed.tolist()) <= {20}


def test_a_plan_says_where_the_car_will_be() -> None:
    scene = perception(ego(10.0), straight_road(), [Walker(40.0, -2.0, 0.0, 0.8)])
    plan = _answers([scene])[0][1]
    np.testing.assert_allclose(np.diff(plan.along), 0.2 * plan.speed[:-1], atol=0.35)
    assert plan.along[0] == pytest.approx(0.0, abs=1e-9)
    assert plan.speed[0] == pytest.approx(10.0)
    for points in plan.overlay.values():
        assert points.shape[1] == 2


def test_the_seed_decides_the_draws_and_nothing_else_does() -> None:
    scene = perception(ego(12.0), straight_road(3, 1), [Walker(17.0, 0.6, 0.0, 0.5)])
    first, again, other = (_answers([scene], seed=seed)[0][1] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.command.steering, again.command.steering)
    np.testing.assert_array_equal(first.overlay["candidate_0"], again.overlay["candidate_0"])
    assert first.overlay.keys() != other.overlay.keys() or any(
        not np.array_equal(first.overlay[name], other.overlay[name]) for name in first.overlay
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("entropy", "speed_risk"),
    [
        ("shannon", "stopping_distance"),
        ("paper", "km/h"),
        ("risk", "squared"),
        *(pytest.param(entropy, "m/s", marks=pytest.mark.slow) for entropy in ("shannon", "paper", "risk")),
    ],
)
def test_every_mode_gets_past_somebody(entropy: str, speed_risk: str) -> None:
    parameters = {"entropy": entropy, "speed_risk": speed_risk}
    ride = _ride(NARROW, [walk(45.0, -3.0, 0.0, 1.2)], duration=6.0, parameters=parameters)
    assert ride.clearance() > 0.25


@pytest.mark.long
@pytest.mark.parametrize("interval", [0.05, 0.5, 1.0])
def test_plans_of_any_length_keep_clear(interval: float) -> None:
    world = ToyWorld(
        NARROW, [ToyPedestrian("p", walk(50.0, -3.5, 0.0, 1.2))], speed=12.0, duration=10.0, step=interval
    )
    ride = Ride()
    run(world, {"ego": catalog.build("drivable_area")}, ride)
    assert ride.clearance() > 0.1


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("friction", 0.0),
        ("margin_m", -0.1),
        ("horizon_s", 0.5),
        ("replan_s", -1.0),
        ("population", 2),
        ("generations", 0),
        ("walks", 0),
        ("entropy_weight", -0.1),
        ("headway_s", float("inf")),
    ],
)
def test_parameters_out_of_range_are_refused_in_one_line(name: str, value: float) -> None:
    with pytest.raises(catalog.CatalogError, match=f"{name} = ") as caught:
        catalog.build("drivable_area", **cast(Any, {name: value}))
    assert "\n" not in str(caught.value)


def test_weights_that_are_all_zero_are_refused() -> None:
    none = dict.fromkeys(("curvature_weight", "distance_weight", "entropy_weight", "progress_weight"), 0.0)
    with pytest.raises(catalog.CatalogError, match="weights"):
        catalog.build("drivable_area", **cast(Any, none))
