"""The four filters: their distances and programs by hand, and rides past somebody on the road without SUMO."""

from __future__ import annotations

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import Decision, Manoeuvre
from controllers.optimisation.settings import SolverSettings
from controllers.yielding.barrier import BarrierFilter, BarrierRule
from controllers.yielding.chance import WalkingUncertainty, tightening
from controllers.yielding.chance_program import ChanceProgram, ChanceWeights
from controllers.yielding.facing import Facing, PathWatch
from controllers.yielding.filtered_driver import FilteredDriver
from controllers.yielding.gap_modes import GapFilter, GapRule, comfortable_stop
from controllers.yielding.responsibility import ResponsibilityFilter, ResponsibilityRule
from cosim.step.toy_road import ToyRoad, walk
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road
from tests.controllers.toy_runs import ride

FILTERS = ("rss", "barrier", "chance_mpc", "gap_hybrid")
RULE = ResponsibilityRule(0.5, 1.8, 4.0, 0.5, 0.2, 0.8, 0.1)
BARRIER = BarrierRule(braking=4.0, rate=1.0, time_margin=1.0, slack_weight=100.0)
GAPS = GapRule(3.0, 9.0, 1.5, 3.0, 2.0, 1.5, 4.0)
ROAD = ToyRoad(lanes=1, lane_width=3.5)


def _facing(walker: Walker, speed: float, wanted: float = 0.0, standoff: float = 1.0) -> Facing:
    scene = perception(ego(speed), straight_road(), [walker])
    return PathWatch(0.3, standoff).look(scene, Decision(Manoeuvre.KEEP, 0), wanted)


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize(("start", "pace"), [(-4.0, 1.3), (-1.0, 0.0), (3.5, -1.0)])
def test_somebody_in_the_way_is_not_touched_and_the_ego_goes_on_once_they_have_left(
    name: str, start: float, pace: float
) -> None:
    track = ride(ROAD, [walk(FRONT + 45.0, start, 0.0, pace)], duration=16.0, controller=name)
    assert track.clearance() > 0.2
    assert np.abs(track.track[1]).max() < 0.3
    gone_on = track.track[0][-1] > FRONT + 60.0
    assert gone_on == (pace != 0.0)


@pytest.mark.parametrize("name", FILTERS)
def test_without_pedestrians_it_is_the_blind_driver(name: str) -> None:
    leader = walk(60.0, 0.0, 6.0, 0.0)
    ours = ride(ROAD, vehicles=[leader], duration=6.0, controller=name)
    other = ride(ROAD, vehicles=[leader], duration=6.0, controller="aeb")
    np.testing.assert_array_equal(ours.commands, other.commands)


def test_the_safe_distance_along_is_that_of_the_rules_and_its_inverse_is_its_inverse() -> None:
    """At 10 m/s: 5 m in half a second, 0.225 m gained, and 10.9² / 8 m of braking."""
    assert RULE.along(10.0) == pytest.approx(5.0 + 0.225 + 10.9**2 / 8.0)
    for speed in (0.0, 3.0, 13.9):
        assert RULE.speed_at(RULE.along(speed)) == pytest.approx(speed, abs=1e-9)
    assert RULE.speed_at(0.0) == 0.0


def test_the_safe_distance_across_grows_with_the_speed_of_who_comes() -> None:
    """At 1 m/s: 0.1 + 0.5 + 0.025 + 1.1² / 1.6; away from the ego the margin is left."""
    found = RULE.across(np.array([1.0, -3.0]))
    np.testing.assert_allclose(found, [0.1 + 0.525 + 1.1**2 / 1.6, 0.1])


def test_in_danger_the_proper_response_is_the_least_braking_of_the_rules_or_what_is_needed() -> None:
    """From 10 m/s 4 m/s² stop within 12.5 m, less than the 14.75 m that are left; of 6.75 m they do not."""
    answer = ResponsibilityFilter(RULE).allowed(_facing(Walker(FRONT + 16.0, 0.0), 10.0))
    assert (answer.most, answer.applies) == (-4.0, True)
    late = ResponsibilityFilter(RULE).allowed(_facing(Walker(FRONT + 8.0, 0.0), 10.0))
    assert late.most == pytest.approx(-(10.0**2) / (2.0 * 6.75))
    far = ResponsibilityFilter(RULE).allowed(_facing(Walker(FRONT + 60.0, 0.0), 10.0, wanted=1.0))
    assert far.most > 1.0


def test_the_barrier_asks_for_the_acceleration_that_its_row_allows() -> None:
    """D = 18.75 m at 10 m/s: h = 18.75 - 12.5 = 6.25, so 10 / 4 · a <= 6.25 - 10, a = -1.5 m/s²."""
    facing = _facing(Walker(FRONT + 20.0, 0.0), 10.0, wanted=0.5)
    gap = float(facing.gaps[0])
    assert gap == pytest.approx(20.0 - 0.25 - 1.0)
    answer = BarrierFilter(BARRIER, SolverSettings()).allowed(facing)
    assert answer.most == pytest.approx((gap - 12.5 - 10.0) / 2.5, abs=0.05)
    assert answer.solved
    assert answer.slack < 0.05


def test_a_barrier_far_away_leaves_what_the_driver_wants() -> None:
    answer = BarrierFilter(BARRIER, SolverSettings()).allowed(
        _facing(Walker(FRONT + 60.0, 0.0), 10.0, wanted=0.5)
    )
    assert answer.most == pytest.approx(0.5, abs=1e-3)


def test_the_barrier_filters_any_controller() -> None:
    """Over one that keeps its speed, whoever is ahead."""
    nominal = catalog.build("constant_speed")
    filtered = FilteredDriver(nominal, BarrierFilter(BARRIER, SolverSettings()), PathWatch(0.6, 1.0))
    scene = perception(ego(10.0), straight_road(), [Walker(FRONT + 20.0, 0.0)])
    plan = filtered.plan(scene, filtered.decide(scene))
    assert plan.command.acceleration.max() < -1.0
    assert plan.own is not None
    assert plan.own.acts
    assert plan.own.deviates


def test_a_chance_constraint_keeps_the_quantile_of_the_risk_it_leaves() -> None:
    """They stand in the middle of the way: p is 1 now, and z(0.99) = 2.326."""
    times = np.array([0.0, 2.0])
    asked = tightening(
        _facing(Walker(FRONT + 20.0, 0.0), 10.0), 0.3, times, WalkingUncertainty(0.3, 0.1), 0.01
    )
    assert asked.counts.all()
    assert asked.margin[0, 0] == pytest.approx(0.25 + 2.326 * 0.1, abs=1e-3)
    # After 2 s the deviation is 0.61 m, and p = P(|N| < 1.45 / 0.61) = 0.9825: z(1 - 0.01 / 0.9825).
    assert asked.margin[0, 1] == pytest.approx(0.25 + 2.319 * np.hypot(0.1, 0.6), abs=5e-3)


def test_somebody_who_is_improbably_in_the_way_asks_for_nothing() -> None:
    facing = _facing(Walker(FRONT + 20.0, -1.5, 0.0, 0.0), 10.0)
    asked = tightening(facing, 0.0, np.array([0.0]), WalkingUncertainty(0.0, 0.1), 0.01)
    assert not asked.counts.any()


def _mode(walker: Walker, speed: float) -> tuple[str, float]:
    answer = GapFilter(GAPS).allowed(_facing(walker, speed, wanted=1.0, standoff=1.5))
    return answer.status, answer.most


def test_the_modes_follow_the_distance_that_is_left() -> None:
    """At 12 m/s 3 m/s² stop within 24 m, 9 m/s² within 8 m; a jerk of 1.5 m/s³ takes another 12 m."""
    mode, most = _mode(Walker(FRONT + 27.0, -3.0, 0.0, 1.2), 12.0)
    assert mode == "mode_yield"
    assert -3.0 <= most < -1.0
    mode, most = _mode(Walker(FRONT + 17.75, -3.0, 0.0, 1.2), 12.0)
    assert mode == "mode_hard_brake"
    assert most == pytest.approx(-(12.0**2) / 32.0)
    assert _mode(Walker(FRONT + 5.0, -3.0, 0.0, 1.2), 12.0)[0] == "mode_pass"
    # Whoever would be met is braked for, however late.
    assert _mode(Walker(FRONT + 5.0, -1.0, 0.0, 1.2), 12.0) == ("mode_hard_brake", -9.0)


def test_somebody_who_steps_out_near_is_braked_hard_for_while_the_ego_yields_to_another() -> None:
    filter_ = GapFilter(GAPS)
    far, near = (Walker(FRONT + ahead, -3.0, 0.0, 1.2) for ahead in (27.0, 17.75))
    told = []
    for walkers in ([far], [far, near], [far, near]):
        scene = perception(ego(12.0), straight_road(), walkers)
        facing = PathWatch(0.3, 1.5).look(scene, Decision(Manoeuvre.KEEP, 0), 1.0)
        told.append(filter_.allowed(facing).status)
    assert told == ["mode_yield", "mode_hard_brake", "mode_hard_brake"]


def test_a_plan_costs_what_its_objective_says() -> None:
    """The program leaves out what no plan changes; the class that is kept is 10 % cheaper of the whole."""
    weights = ChanceWeights(speed=1.0, acceleration=0.5, change=0.2, violation=1000.0)
    program = ChanceProgram(0.5, 8, weights, 9.0, SolverSettings("osqp", 1e-6))
    speed, before, wanted = 8.0, -2.0, np.full(8, 10.0)
    upper = np.full(8, 20.0)
    problem = program.problem(speed, before, wanted, upper, np.full(8, -np.inf), 2.0)
    plan = program.solve(problem, speed, before, wanted)
    jerk = np.diff(plan.acceleration, prepend=before) / 0.5
    over = max(float((plan.position - upper).max()), 0.0)
    squares = (plan.speed - wanted) ** 2 + 0.5 * plan.acceleration**2 + 0.2 * jerk**2
    assert plan.solved
    assert plan.cost == pytest.approx(0.5 * squares.sum() + 1000.0 * over**2, rel=1e-3)
    assert plan.cost > 0.0


def test_who_waits_or_comes_long_after_the_ego_is_not_minded() -> None:
    assert _mode(Walker(FRONT + 32.0, -3.0), 12.0)[0] == "ok"
    assert _mode(Walker(FRONT + 10.0, -9.0, 0.0, 1.2), 12.0)[0] == "ok"


def test_a_comfortable_stop_takes_the_distance_of_its_trapezoid() -> None:
    """v² / (2 a) + v a / (2 j) above a² / j = 6 m/s; below, a triangle of two ramps √(v / j) long each."""
    for speed, distance in ((12.0, 36.0), (6.0, 12.0), (1.5, 1.5)):
        profile = comfortable_stop(speed, 3.0, 1.5)
        assert profile.distance[-1] == pytest.approx(distance, rel=1e-3)
        np.testing.assert_allclose(profile.at(distance + 1.0), (speed, 0.0))
        np.testing.assert_allclose(profile.at(0.0), (0.0, 0.0), atol=1e-9)
        assert profile.acceleration.min() >= -3.0


def test_yielding_stops_before_the_pedestrian_with_comfortable_braking() -> None:
    track = ride(ROAD, [walk(FRONT + 60.0, -0.5, 0.0, 0.01)], duration=12.0, controller="gap_hybrid")
    assert 0.5 < track.clearance() < 2.5
    assert track.commands[:, 0].min() > -4.0
