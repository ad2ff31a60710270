"""Plans its speed as a trapezoid that ends standing before where an obstacle is now: the classic planning.

Along: a plan of constant accelerations for the leader, whose motion it ignores, and for every place to stop
at for pedestrians, made anew every period; the ego drives the most restrictive one. A car-following driver
handles signals, right of way, bends and lower limits ahead, and automatic emergency braking acts for road
users without a plan. Across: lane keeping, and lane changes that the route requires or that lead around slow
and standing vehicles, into gaps that stay safe.
"""

from __future__ import annotations

from controllers.interface import Controller
from controllers.prediction import by_name
from controllers.speed_plans.plan_keeping import PlanSettings, Replanning
from controllers.speed_plans.settings import SpeedPlanSettings
from controllers.speed_plans.speed_plan_driver import PlanFrom, SpeedPlanDriver
from controllers.speed_plans.trapezoid_profile import plan_trapezoid, stopping_gap


class Settings(SpeedPlanSettings):
    """The parameters that all controllers with speed plans share."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    return SpeedPlanDriver(
        PlanSettings(plan_trapezoid, stopping_gap, Replanning.PERIODIC, settings.period_s),
        settings.limits(),
        PlanFrom.MEASURED,
        settings.style(),
        settings.crossing_rule(),
        by_name.sampled(settings.predictor, seed=settings.seed),
        settings.brake(),
    )
