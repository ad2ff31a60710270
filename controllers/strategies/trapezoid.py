"""Plans its speed as a trapezoid that ends standing before where an obstacle is now: the classic planning.

Along: a plan of constant accelerations for the leader, whose motion it does not know of, and for every place
to stop at for pedestrians, made anew every period; the most restrictive one is driven. Signals, right of
way, bends and lower limits ahead are those of a car-following driver; automatic emergency braking is there
for whoever no plan is made for. Across: lane keeping, and lane changes that the route asks for or that lead
around slow and standing vehicles, into gaps that stay safe.
"""

from __future__ import annotations

from controllers.interface import Controller
from controllers.prediction import by_name
from controllers.speed_plans.plan_keeping import PlanSettings, Replanning
from controllers.speed_plans.settings import SpeedPlanSettings
from controllers.speed_plans.speed_plan_driver import PlanFrom, SpeedPlanDriver
from controllers.speed_plans.trapezoid_profile import plan_trapezoid, stopping_gap


class Settings(SpeedPlanSettings):
    """What can be set: what all controllers have that plan their speed."""


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
