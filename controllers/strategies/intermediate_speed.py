"""Plans its speed by an intermediate speed, so that it reaches an obstacle's speed at the safe distance.

Along: a plan of constant accelerations for the leader and for every place to stop at for pedestrians, of
which the ego drives the most restrictive one. A car-following driver handles signals, right of way, bends and
lower limits ahead, and automatic emergency braking acts for road users without a plan. Across: lane keeping,
and lane changes that the route requires or that lead around slow and standing vehicles, into gaps that stay
safe.
"""

from __future__ import annotations

from controllers.interface import Controller
from controllers.prediction import by_name
from controllers.settings import PositiveOrInfinite
from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.plan_keeping import PlanSettings, Replanning
from controllers.speed_plans.settings import SpeedPlanSettings
from controllers.speed_plans.speed_plan_driver import PlanFrom, SpeedPlanDriver


class Settings(SpeedPlanSettings):
    """The parameters of the controller."""

    replanning: Replanning = Replanning.EVENT
    """When to plan anew. event: when the gap, the obstacle's speed or the governing obstacle is not as
    planned; periodic: every period_s."""
    plan_from: PlanFrom = PlanFrom.PREDICTED
    """State from which plans begin. predicted: the state in which all commands under way have taken effect;
    commanded: the commanded speed and the present gap, as in the paper's cascade; measured: the present speed
    and gap."""
    jerk_mps3: PositiveOrInfinite = float("inf")
    """Jerk limit of the plans; inf for the paper's plans, which have none."""
    predict: bool = False
    """Whether to predict that leaders go on braking or speeding up for a while, and that pedestrians
    leave."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    plans = PlanSettings(
        plan_intermediate,
        safe_distance,
        settings.replanning,
        settings.period_s,
        settings.jerk_mps3,
        settings.predict,
    )
    return SpeedPlanDriver(
        plans,
        settings.limits(),
        settings.plan_from,
        settings.style(),
        settings.crossing_rule(),
        by_name.sampled(settings.predictor, seed=settings.seed),
        settings.brake(),
    )
