"""Plans its speed by an intermediate speed, so that it reaches an obstacle's speed at the safe distance.

Along: a plan of constant accelerations for the leader and for every place to stop at for pedestrians, of
which the most restrictive one is driven; signals, right of way, bends and lower limits ahead are those of a
car-following driver; automatic emergency braking is there for whoever no plan is made for. Across: lane
keeping, and lane changes that the route asks for or that lead around slow and standing vehicles, into gaps
that stay safe.
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
    """What can be set."""

    replanning: Replanning = Replanning.EVENT
    """event: when the gap, the obstacle's speed or the governing obstacle is not as planned; periodic: every
    period_s."""
    plan_from: PlanFrom = PlanFrom.PREDICTED
    """predicted: from the state in which all commands under way have taken effect; commanded: from the
    commanded speed and the present gap, as the paper's cascade does; measured: from the present speed."""
    jerk_mps3: PositiveOrInfinite = float("inf")
    """Limit of the plans; inf for the paper's."""
    predict: bool = False
    """Whether leaders are expected to go on braking or speeding up for a while, and pedestrians to leave."""


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
