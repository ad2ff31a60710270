"""Speed plans that are kept while they fit: when a new one is made, and how."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial

import numpy as np

from controllers.speed_plans.actuator_prediction import PredictedState
from controllers.speed_plans.jerk_limit import Planner, plan_with_jerk_limit
from controllers.speed_plans.obstacle_prediction import expected_obstacle, plan_for_braking, plan_until_gone
from controllers.speed_plans.speed_targets import FREE, SpeedTarget
from controllers.speed_plans.trapezoid_profile import PlannedSpeed, PlanningLimits, Situation, free_profile

STEADY = 0.2
"""An obstacle's acceleration smaller than this is not expected to go on [m/s^2]."""
OTHER_SPEED = 0.1
"""The ego does not start on a plan whose speed differs from its own by more than this [m/s]."""
ENDS_AT_NO_GAP = frozenset({"0", "gone"})
"""Cases of plans that end at no given gap."""


class Replanning(StrEnum):
    """When to plan anew."""

    EVENT = "event"
    """When the plan no longer fits."""
    PERIODIC = "periodic"
    """At fixed intervals."""


@dataclass(frozen=True, slots=True)
class Triggers:
    """Deviations from which a plan no longer fits."""

    gap: float = 1.0
    """The gap differs from the predicted gap by more than this [m]."""
    speed: float = 0.2
    """The obstacle's speed has changed by more than this [m/s]."""
    end: float = 0.3
    """The plan is over, and the gap differs from its final gap by more than this [m]."""
    own_speed: float = 0.5
    """With nothing ahead, the ego's speed differs from the planned speed by more than this [m/s]."""
    gone: float = 0.5
    """The time at which the obstacle will be gone has changed by more than this [s]."""


@dataclass(frozen=True, slots=True)
class PlanSettings:
    """How plans are made."""

    planner: Planner
    final_gap: Callable[[float, PlanningLimits], float]
    """Function from the obstacle's speed and the limits to the gap at which a plan ends [m]."""
    replanning: Replanning = Replanning.EVENT
    period: float = 0.1
    """Time between plans with ``PERIODIC`` [s]."""
    jerk: float = float("inf")
    """Jerk limit [m/s^3]."""
    predict: bool = False
    """Whether obstacles are expected to go on speeding up, braking or leaving."""
    triggers: Triggers = field(default_factory=Triggers)


@dataclass(frozen=True, slots=True)
class Moment:
    """One instant of planning."""

    now: float
    """Time on the plans' clock, which may be ahead of the ego's clock [s]."""
    state: PredictedState
    """State in which plans begin."""
    limits: PlanningLimits
    before: float
    """Acceleration from which plans continue [m/s^2]."""
    delay: float
    """How much later than planned the ego is known to move [s]."""


@dataclass(frozen=True, slots=True)
class KeptPlan:
    """A speed plan and what it was made for."""

    target: SpeedTarget
    plan: PlannedSpeed
    since: float
    """When its clock began [s]."""
    situation: Situation
    """Situation at that time; the gap is inf with nothing ahead."""
    limits: PlanningLimits
    final_gap: float | None
    """Gap at which the plan ends; ``None`` if it ends at no given gap [m]."""
    gone: float
    """Time at which the obstacle is expected to be gone, on the same clock; inf for never [s]."""
    delay: float

    def expected(self, now: float) -> tuple[float, float]:
        """Return the gap and the ego's speed that the plan predicts for a time [m, m/s]."""
        elapsed = now - self.since
        moved, speed, _ = self.plan.profile.at(max(elapsed - self.delay, 0.0))
        moved += self.plan.profile.speed * min(elapsed, self.delay)
        return self.situation.gap + self.situation.obstacle_speed * elapsed - moved, speed

    def has_speed(self, now: float, speed: float) -> bool:
        """Return whether the plan has this speed now; a plan that was not driven for a while may not."""
        return abs(self.plan.profile.at(now - self.since)[1] - speed) <= OTHER_SPEED

    def fits(
        self, now: float, situation: Situation, limits: PlanningLimits, gone: float, triggers: Triggers
    ) -> bool:
        """Return whether the plan can be kept.

        Parameters
        ----------
        now : time on its clock [s]
        situation, limits, gone : present values
        triggers : deviations from which it no longer fits
        """
        if limits != self.limits:
            return False
        gap, speed = self.expected(now)
        if np.isinf(situation.gap):
            return abs(speed - situation.speed) <= triggers.own_speed
        if abs(situation.obstacle_speed - self.situation.obstacle_speed) > triggers.speed:
            return False
        if gone != self.gone and not abs(gone - self.gone) <= triggers.gone:
            return False
        over = now - self.since >= self.plan.profile.duration + self.delay - 1e-9
        if over and self.final_gap is not None and abs(situation.gap - self.final_gap) > triggers.end:
            return False
        return abs(situation.gap - gap) <= triggers.gap


class PlanKeeper:
    """The plans of one ego, one for each present target."""

    def __init__(self, settings: PlanSettings) -> None:
        self.settings = settings
        self._kept: dict[str, KeptPlan] = {}
        self._planned_at = -np.inf

    def due(self, time: float) -> bool:
        """Return whether the clock calls for new plans, and begin a new period if so."""
        settings = self.settings
        if settings.replanning is Replanning.EVENT or time < self._planned_at + settings.period - 1e-9:
            return False
        self._planned_at = time
        return True

    def forget_others(self, keys: set[str]) -> None:
        """Keep only the plans for these targets."""
        self._kept = {key: kept for key, kept in self._kept.items() if key in keys}

    def plan_for(self, target: SpeedTarget, moment: Moment, *, renew: bool) -> tuple[KeptPlan, Situation]:
        """Return the plan for a target, which is the last one while that fits, and the present situation.

        Parameters
        ----------
        target : what to plan for
        moment : the present instant
        renew : whether to make a new plan in any case
        """
        settings, state = self.settings, moment.state
        limits = replace(moment.limits, standoff=target.standoff)
        seen = Situation(state.gap(target.gap, target.speed), state.speed, target.speed)
        braking = settings.predict and abs(target.acceleration) > STEADY
        situation = expected_obstacle(seen, target.acceleration) if braking else seen
        leaves = max(target.leaves - state.delay, 0.0) if settings.predict else np.inf
        gone = moment.now + leaves
        kept = self._kept.get(target.key)
        if kept is not None and not renew:
            periodic = settings.replanning is Replanning.PERIODIC
            if periodic or kept.fits(moment.now, situation, limits, gone, settings.triggers):
                return kept, situation
        planner = settings.planner if target is not FREE else _free
        if np.isfinite(leaves):
            planner = partial(_until_gone, planner, leaves, target.body_gap - state.ahead)
        if np.isfinite(settings.jerk):
            planner = partial(_smooth, planner, settings.jerk, moment.before)
        if braking:
            plan = plan_for_braking(planner, seen, limits, target.acceleration)
        else:
            plan = planner(seen, limits)
        ends = target is not FREE and plan.case not in ENDS_AT_NO_GAP
        final = settings.final_gap(situation.obstacle_speed, limits) if ends else None
        kept = KeptPlan(target, plan, moment.now, situation, limits, final, gone, moment.delay)
        self._kept[target.key] = kept
        return kept, situation


def _free(situation: Situation, limits: PlanningLimits) -> PlannedSpeed:
    return PlannedSpeed(free_profile(situation.speed, limits), "free")


def _until_gone(
    planner: Planner, leaves: float, body_gap: float, situation: Situation, limits: PlanningLimits
) -> PlannedSpeed:
    return plan_until_gone(planner, situation, limits, leaves, body_gap)


def _smooth(
    planner: Planner, jerk: float, before: float, situation: Situation, limits: PlanningLimits
) -> PlannedSpeed:
    return plan_with_jerk_limit(planner, situation, limits, jerk, before)
