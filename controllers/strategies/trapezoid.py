"""Plans its speed as a trapezoid that ends standing before where an obstacle is now: the classic planning.

Along: a plan of constant accelerations for the leader, whose motion it does not know of, and for every place
to stop at for pedestrians, made anew every period; the most restrictive one is driven. Signals, right of
way, bends and lower limits ahead are those of a car-following driver; automatic emergency braking is there
for whoever no plan is made for. Across: lane keeping, and lane changes that the route asks for or that lead
around slow and standing vehicles, into gaps that stay safe.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.emergency_braking import EmergencyBraking
from controllers.interface import Controller
from controllers.prediction import named
from controllers.speed_plans.plan_keeping import PlanSettings, Replanning
from controllers.speed_plans.speed_plan_driver import PlanFrom, SpeedPlanDriver
from controllers.speed_plans.speed_targets import CrossingRule
from controllers.speed_plans.trapezoid_profile import PlanningLimits, plan_trapezoid, stopping_gap


def build(
    *,
    acceleration_mps2: float = 1.723,
    deceleration_mps2: float = 2.0,
    emergency_deceleration_mps2: float = 8.0,
    max_speed_mps: float = float("inf"),
    actuator_delay_s: float = 0.3,
    standoff_m: float = 2.5,
    period_s: float = 0.1,
    time_margin_s: float = 1.0,
    side_margin_m: float = 0.6,
    emergency_brake: bool = True,
    predictor: str = named.CONSTANT_VELOCITY,
    seed: int = 1,
) -> Controller:
    """Build the controller.

    Parameters
    ----------
    acceleration_mps2, deceleration_mps2, emergency_deceleration_mps2 : float
        Of a normal plan, and the most that an emergency may use [m/s^2].
    max_speed_mps : float
        Driven where the road allows it [m/s].
    actuator_delay_s : float
        α, from a command to its effect [s].
    standoff_m : float
        d_extra, left to an obstacle after a stop [m].
    period_s : float
        Time between two plans; shorter than that between two perceptions means at each of them [s].
    time_margin_s : float
        The ego goes ahead of a pedestrian who comes into its way this long after it is past [s].
    side_margin_m : float
        What a pedestrian's disc is grown by across the way [m].
    emergency_brake : bool
        Whether automatic emergency braking, as of ``aeb``, is there for whoever no plan is made for.
    predictor : str
        How pedestrians are expected to walk; one of ``controllers.prediction.named.names()``.
    seed : int
        Of a predictor that draws random numbers.

    Raises
    ------
    ValueError
        If a parameter is out of range, or there is no such predictor.
    """
    limits = PlanningLimits(
        acceleration_mps2,
        deceleration_mps2,
        emergency_deceleration_mps2,
        max_speed_mps,
        actuator_delay_s,
        standoff_m,
    )
    limits.check()
    if not period_s > 0.0:
        raise ValueError(f"period_s must be greater than 0, not {period_s}")
    rule = CrossingRule(standoff_m, side_margin=side_margin_m, time_margin=time_margin_s)
    rule.check()
    plans = PlanSettings(plan_trapezoid, stopping_gap, Replanning.PERIODIC, period_s)
    brake = EmergencyBraking() if emergency_brake else None
    style = DrivingStyle(standstill_gap=standoff_m, acceleration=max(acceleration_mps2, 1.8))
    return SpeedPlanDriver(
        plans, limits, PlanFrom.MEASURED, style, rule, named.sampled(predictor, seed=seed), brake
    )
