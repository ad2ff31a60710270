"""Plans its speed by an intermediate speed, so that it reaches an obstacle's speed at the safe distance.

Along: a plan of constant accelerations for the leader and for every place to stop at for pedestrians, of
which the most restrictive one is driven; signals, right of way, bends and lower limits ahead are those of a
car-following driver; automatic emergency braking is there for whoever no plan is made for. Across: lane
keeping, and lane changes that the route asks for or that lead around slow and standing vehicles, into gaps
that stay safe.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.emergency_braking import EmergencyBraking
from controllers.interface import Controller
from controllers.prediction import named
from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.plan_keeping import PlanSettings, Replanning
from controllers.speed_plans.speed_plan_driver import PlanFrom, SpeedPlanDriver
from controllers.speed_plans.speed_targets import CrossingRule
from controllers.speed_plans.trapezoid_profile import PlanningLimits


def build(
    *,
    acceleration_mps2: float = 1.723,
    deceleration_mps2: float = 2.0,
    emergency_deceleration_mps2: float = 8.0,
    max_speed_mps: float = float("inf"),
    actuator_delay_s: float = 0.3,
    standoff_m: float = 2.5,
    replanning: Replanning = Replanning.EVENT,
    period_s: float = 0.1,
    plan_from: PlanFrom = PlanFrom.PREDICTED,
    jerk_mps3: float = float("inf"),
    predict: bool = False,
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
        α, from a command to its effect, the drive's lag included; what exceeds that is taken as dead time
        [s].
    standoff_m : float
        d_extra, left to an obstacle after a stop [m].
    replanning : Replanning
        ``event``: when the gap, the obstacle's speed or the governing obstacle is not as planned;
        ``periodic``: every ``period_s``.
    period_s : float
        Shorter than the time between two plans means at each of them [s].
    plan_from : PlanFrom
        ``predicted``: from the state in which all commands under way have taken effect; ``commanded``: from
        the commanded speed and the present gap, as the paper's cascade does; ``measured``: from the present
        speed.
    jerk_mps3 : float
        Limit of the plans; inf for the paper's [m/s^3].
    predict : bool
        Whether leaders are expected to go on braking or speeding up for a while, and pedestrians to leave.
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
    for name, value in {"period_s": period_s, "jerk_mps3": jerk_mps3}.items():
        if not value > 0.0:
            raise ValueError(f"{name} must be greater than 0, not {value}")
    rule = CrossingRule(standoff_m, side_margin=side_margin_m, time_margin=time_margin_s)
    rule.check()
    plans = PlanSettings(plan_intermediate, safe_distance, replanning, period_s, jerk_mps3, predict)
    brake = EmergencyBraking() if emergency_brake else None
    style = DrivingStyle(standstill_gap=standoff_m, acceleration=max(acceleration_mps2, 1.8))
    return SpeedPlanDriver(plans, limits, plan_from, style, rule, named.sampled(predictor, seed=seed), brake)
