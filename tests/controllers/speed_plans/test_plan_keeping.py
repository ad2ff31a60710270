"""When a speed plan is kept and when it is made anew."""

from __future__ import annotations

from dataclasses import replace

import pytest

from controllers.speed_plans.actuator_prediction import PredictedState
from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.plan_keeping import KeptPlan, Moment, PlanKeeper, PlanSettings, Replanning
from controllers.speed_plans.speed_targets import FREE, SpeedTarget
from controllers.speed_plans.trapezoid_profile import PlanningLimits

LIMITS = PlanningLimits(1.8, 2.0, 8.0, 13.0, 0.0, 2.5)
LEADER = SpeedTarget("leader", "leader", 60.0, 8.0, standoff=2.5)


def _keeper(**changes: object) -> PlanKeeper:
    return PlanKeeper(replace(PlanSettings(plan_intermediate, safe_distance), **changes))  # type: ignore[arg-type]


def _moment(now: float, speed: float = 12.0, before: float = 0.0, limits: PlanningLimits = LIMITS) -> Moment:
    return Moment(now, PredictedState(speed, 0.0, 0.0), limits, before, 0.0)


def _as_planned(kept: KeptPlan, now: float) -> tuple[SpeedTarget, Moment]:
    """Return what is there when everything went as planned."""
    gap, speed = kept.expected(now)
    return replace(LEADER, gap=gap), _moment(now, speed)


def _first(keeper: PlanKeeper, target: SpeedTarget = LEADER) -> KeptPlan:
    return keeper.plan_for(target, _moment(0.0), renew=False)[0]


def test_a_plan_is_kept_while_all_is_as_planned() -> None:
    keeper = _keeper()
    first = _first(keeper)
    for step in range(1, 300):
        target, moment = _as_planned(first, 0.1 * step)
        kept, situation = keeper.plan_for(target, moment, renew=False)
        assert kept is first
        assert situation.gap == pytest.approx(first.expected(0.1 * step)[0])


@pytest.mark.parametrize(("off", "again"), [(0.9, False), (-0.9, False), (1.1, True), (-1.1, True)])
def test_a_gap_that_is_not_as_predicted_leads_to_a_new_plan(off: float, again: bool) -> None:
    keeper = _keeper()
    first = _first(keeper)
    target, moment = _as_planned(first, 1.0)
    kept, _ = keeper.plan_for(replace(target, gap=target.gap + off), moment, renew=False)
    assert (kept is not first) is again


@pytest.mark.parametrize(("change", "again"), [(0.15, False), (-0.15, False), (0.25, True), (-0.25, True)])
def test_an_obstacle_that_changes_its_speed_leads_to_a_new_plan(change: float, again: bool) -> None:
    keeper = _keeper()
    first = _first(keeper)
    target, moment = _as_planned(first, 1.0)
    kept, _ = keeper.plan_for(replace(target, speed=8.0 + change), moment, renew=False)
    assert (kept is not first) is again


@pytest.mark.parametrize(("off", "again"), [(0.2, False), (0.4, True)])
def test_a_plan_that_is_over_and_missed_its_gap_is_followed_by_another(off: float, again: bool) -> None:
    keeper = _keeper()
    first = _first(keeper)
    target, moment = _as_planned(first, first.plan.profile.duration + 1.0)
    kept, _ = keeper.plan_for(replace(target, gap=target.gap + off), moment, renew=False)
    assert (kept is not first) is again


def test_a_new_speed_limit_leads_to_a_new_plan() -> None:
    keeper = _keeper()
    first = _first(keeper)
    target, moment = _as_planned(first, 0.5)
    slower = replace(moment, limits=replace(LIMITS, top_speed=8.0))
    assert keeper.plan_for(target, slower, renew=False)[0] is not first


def test_with_nothing_ahead_only_the_own_speed_matters() -> None:
    keeper = _keeper()
    first = _first(keeper, FREE)
    speed = first.expected(0.3)[1]
    assert keeper.plan_for(FREE, _moment(0.3, speed - 0.4), renew=False)[0] is first
    assert keeper.plan_for(FREE, _moment(0.3, speed - 0.6), renew=False)[0] is not first


def test_a_target_that_is_gone_is_forgotten() -> None:
    keeper = _keeper()
    first = _first(keeper)
    keeper.forget_others({"somebody else"})
    target, moment = _as_planned(first, 0.1)
    assert keeper.plan_for(target, moment, renew=False)[0] is not first


def test_by_the_clock_plans_are_due_once_a_period() -> None:
    keeper = _keeper(replanning=Replanning.PERIODIC, period=0.5)
    assert [keeper.due(0.1 * step) for step in range(11)] == [step % 5 == 0 for step in range(11)]
    first = _first(keeper)
    target, moment = _as_planned(first, 0.1)
    assert keeper.plan_for(replace(target, gap=1.0), moment, renew=False)[0] is first
    assert keeper.plan_for(target, moment, renew=True)[0] is not first


def test_by_events_nothing_is_ever_due() -> None:
    assert not any(_keeper().due(float(time)) for time in range(5))


def test_a_known_delay_is_expected() -> None:
    keeper = _keeper()
    late = replace(_moment(0.0, 10.0), delay=0.7)
    kept, _ = keeper.plan_for(LEADER, late, renew=False)
    gap, speed = kept.expected(0.7)
    assert speed == 10.0
    assert gap == pytest.approx(60.0 + 0.7 * (8.0 - 10.0))
    moved = kept.plan.profile.at(1.3)[0]
    assert kept.expected(2.0)[0] == pytest.approx(60.0 + 16.0 - 7.0 - moved)


def test_with_prediction_a_leader_s_braking_is_planned_for() -> None:
    braking = replace(LEADER, acceleration=-3.0)
    plain, told = (_first(_keeper(predict=flag), braking) for flag in (False, True))
    assert told.plan.profile.final_speed == pytest.approx(2.0)
    assert plain.plan.profile.final_speed == pytest.approx(8.0)


def test_with_prediction_another_time_of_leaving_leads_to_a_new_plan() -> None:
    keeper = _keeper(predict=True)
    place = SpeedTarget("crossing", "p", 40.0, leaves=4.0, body_gap=43.0)
    first, _ = keeper.plan_for(place, _moment(0.0), renew=False)
    assert first.plan.case == "gone"
    gap, speed = first.expected(1.0)
    for leaves, again in ((3.2, False), (4.5, True), (float("inf"), True)):
        seen = replace(place, gap=gap, leaves=leaves)
        kept, _ = keeper.plan_for(seen, _moment(1.0, speed), renew=False)
        assert (kept is not first) is again


def test_a_smooth_plan_goes_on_from_the_present_acceleration() -> None:
    keeper = _keeper(jerk=1.0)
    kept, _ = keeper.plan_for(LEADER, _moment(0.0, before=-0.6), renew=False)
    assert kept.plan.profile.at(0.0)[2] == pytest.approx(-0.6)
    assert max(abs(one.jerk) for one in kept.plan.profile.segments) <= 1.0 + 1e-5
