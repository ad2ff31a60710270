"""Costs and constraints of candidates past a pedestrian."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from controllers.arrays import FloatArray
from controllers.drivable_area.clearances import Boxes, Shape
from controllers.drivable_area.costs import (
    CostWeights,
    SpeedRisk,
    curvature_cost,
    distance_cost,
    speed_risk,
)
from controllers.drivable_area.drivable_entropy import EntropyMode
from controllers.drivable_area.evaluation import CarLimits, Rules, Scene, Verdict, judge
from controllers.drivable_area.quintic_path import PathStart, quintic_paths
from controllers.interface import Body
from controllers.prediction.social_force_model import Walkers
from controllers.safety.emergency_braking import GRAVITY


def _walker(x: float, y: float, x_speed: float = 0.0, y_speed: float = 0.0) -> Walkers:
    return Walkers(*(np.array([value]) for value in (x, y, x_speed, y_speed)))


NOBODY = Walkers(*(np.zeros(0) for _ in range(4)))
RULES = Rules()
SCENE = Scene(
    Shape(Body()), CarLimits(), PathStart(), 10.0, 10.0, 0.0, 25.0, 23.0, -1.75, 5.25, _walker(28.55, 0.3)
)


def _judged(scene: Scene, end: list[float], speed: list[float], rules: Rules = RULES) -> Verdict:
    walks = np.random.default_rng(1).standard_normal((len(rules.times), len(scene.people.x), rules.walks))
    return judge(scene, rules, np.array(end), np.array(speed), walks)


def test_straight_on_at_speed_meets_somebody_in_the_way_and_going_round_or_stopping_does_not() -> None:
    verdict = _judged(SCENE, [0.0, 3.5, 0.0], [10.0, 10.0, 0.0])
    assert verdict.feasible.tolist() == [False, True, True]
    assert verdict.violations[0, 0] == pytest.approx(0.3 + 0.35 + 0.9 - 0.3, abs=0.01)
    assert verdict.meetings.collision.tolist() == [1.0, 0.0, 0.0]
    np.testing.assert_allclose(verdict.costs[:, 3], [0.0, 0.0, 1.0])


def test_stopping_costs_nothing_at_all_but_progress() -> None:
    costs = _judged(SCENE, [0.0], [0.0]).costs[0]
    np.testing.assert_allclose(costs, [0.0, 0.0, 0.0, 1.0], atol=1e-9)
    assert CostWeights().total(costs[None])[0] == pytest.approx(0.0, abs=1e-9)
    assert CostWeights(progress=0.5).total(costs[None])[0] == pytest.approx(0.5)


def test_the_other_lane_is_no_way_where_somebody_drives_in_it() -> None:
    place = 12.0 + 8.0 * RULES.times
    beside = Boxes(
        place[None], np.full_like(place, 3.5)[None], np.zeros(1), np.array([2.25]), np.array([0.9])
    )
    assert _judged(replace(SCENE, boxes=beside), [3.5], [10.0]).violations[0, 1] > 0.0
    assert _judged(replace(SCENE, boxes=beside), [0.0], [0.0]).violations[0, 1] <= 0.0


def test_who_overlaps_already_or_is_nearer_than_the_margin_does_not_forbid_to_drive_on() -> None:
    standing = np.zeros((1, len(RULES.times)))
    overlapping = Boxes(standing + 1.0, standing + 0.5, np.zeros(1), np.array([2.25]), np.array([0.9]))
    near = replace(overlapping, y=standing - 1.95)
    for boxes in (overlapping, near):
        scene = replace(SCENE, people=NOBODY, boxes=boxes, start=PathStart(0.0))
        assert _judged(scene, [0.0], [10.0]).violations[0, 1] <= 0.0


def test_the_road_ends_at_its_edges() -> None:
    verdict = _judged(replace(SCENE, people=NOBODY), [-0.7, -0.75, 4.0, 4.1], [10.0] * 4)
    assert (verdict.violations[:, 2] <= 0.0).tolist() == [True, False, True, False]


def test_candidates_beyond_the_grip_are_refused_only_with_the_switch() -> None:
    scene = replace(SCENE, people=NOBODY, speed=40 / 3.6, length=10.0, braking_distance=10.0)
    loose = replace(RULES, within_friction=False)
    for shift, possible in ((1.0, True), (1.2, False)):
        assert bool(_judged(scene, [shift], [40 / 3.6], loose).feasible[0])
        steady = replace(scene, limits=replace(scene.limits, steering_rate=9.0))
        assert bool(_judged(steady, [shift], [40 / 3.6]).feasible[0]) == possible
    verdict = _judged(scene, [1.2], [40 / 3.6], loose)
    assert verdict.lateral[0] == pytest.approx(10.0 / np.sqrt(3.0) * 1.2 / 100.0 * (40 / 3.6) ** 2, rel=0.02)
    assert verdict.lateral[0] > 0.8 * GRAVITY


def test_a_wheel_that_has_to_turn_too_fast_is_a_limit_too() -> None:
    scene = replace(SCENE, people=NOBODY, speed=8.0, length=6.0)
    assert _judged(scene, [0.6], [8.0]).violations[0, 3] > 0.0
    free = replace(scene, limits=replace(scene.limits, steering_rate=5.0))
    assert _judged(free, [0.6], [8.0]).violations[0, 3] <= 0.0


@settings(max_examples=40, deadline=None)
@given(some.floats(0.0, 20.0), some.floats(-7.0, 2.0), some.floats(0.0, 1.0), some.floats(0.0, 50.0))
def test_speeds_stay_between_and_brake_no_harder_than_allowed(
    speed: float, begin: float, share: float, room: float
) -> None:
    scene = replace(SCENE, people=NOBODY, speed=speed, acceleration=begin, braking_distance=room)
    for rules in (RULES, replace(RULES, full_braking=True)):
        moving = _judged(scene, [0.0], [share * speed], rules).motions
        assert moving.speed.min() >= share * speed - 1e-6
        assert moving.acceleration.min() >= -0.8 * GRAVITY - 1e-6
        assert np.isfinite(moving.along).all()


def test_a_final_speed_is_reached_where_it_is_needed() -> None:
    scene = replace(SCENE, people=NOBODY)
    moving = _judged(scene, [0.0, 0.0], [0.0, 4.0], replace(RULES, horizon=12.0)).motions
    assert moving.along[0, -1] == pytest.approx(23.0, abs=1e-6)
    there = np.flatnonzero(moving.speed[1] <= 4.0 + 1e-3)[0]
    assert moving.along[1, there] == pytest.approx(23.0, abs=0.6)


def test_the_costs_of_the_paper_at_a_shift_from_a_straight_start() -> None:
    paths = quintic_paths(PathStart(1.55), 20.0, np.array([1.97, 1.55]))
    # ∫ |y″| dx = 3.75 shift / length for a small slope.
    assert curvature_cost(paths, 0.1) == pytest.approx([3.75 * 0.42 / 20.0 / 20.0 / 0.1, 0.0], rel=2e-3)


def test_the_readings_of_the_speed_coefficient() -> None:
    speed = np.array([4.9])
    expected = {
        SpeedRisk.METRES_PER_SECOND: 0.0918,
        SpeedRisk.KILOMETRES_PER_HOUR: 0.3306,
        SpeedRisk.SQUARED: 0.125,
        SpeedRisk.STOPPING_DISTANCE: 1.225,
    }
    for form, value in expected.items():
        assert speed_risk(speed, form)[0] == pytest.approx(value, abs=1e-4)
        assert speed_risk(np.zeros(1), form)[0] == 0.0


def test_nearness_costs_and_nobody_costs_nothing() -> None:
    costs: FloatArray = distance_cost(np.full(4, 0.1), np.array([np.inf, 1.0, 0.1, -0.5]))
    np.testing.assert_allclose(costs, [0.0, 0.1, 1.0, 2.0])


@pytest.mark.parametrize("mode", EntropyMode)
def test_uncertain_meetings_cost_in_every_mode_and_empty_roads_in_none(mode: EntropyMode) -> None:
    rules = replace(RULES, entropy=mode, walks=64, model=replace(RULES.model, spread=0.4))
    scene = replace(SCENE, people=_walker(20.0, -3.0, 0.0, 1.2))
    assert _judged(scene, [0.0], [8.0], rules).costs[0, 2] > 0.0
    assert _judged(replace(scene, people=NOBODY), [0.0], [8.0], rules).costs[0, 2] == 0.0


def test_a_wider_spread_of_walking_speeds_makes_meetings_less_certain() -> None:
    scene = replace(SCENE, people=_walker(20.0, -3.0, 0.0, 1.2))
    costs = [
        _judged(scene, [0.0], [8.0], replace(RULES, walks=200, model=replace(RULES.model, spread=spread)))
        for spread in (0.0, 0.3)
    ]
    assert costs[0].costs[0, 2] < costs[1].costs[0, 2]
    assert costs[0].meetings.collision[0] in (0.0, 1.0)
