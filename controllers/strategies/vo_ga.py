"""The velocity-obstacle paper with its own solver: least change of inputs, by a genetic algorithm.

Along: while pedestrians are in conflict, the plan that changes the speed least and keeps out of everybody's
collision cone, made by a genetic algorithm every ``replan_s`` and followed in between; else, and never
exceeded, what leaders, signals, right of way, bends and limits allow. Across: lane keeping; where the
decision rules leave the choice, a change of lane that is the cheaper way to avoid somebody, and those that
route and traffic ask for. The sequential quadratic programs for the same problem are ``vo_mpc`` with
``model=paper``.
"""

from __future__ import annotations

from controllers.avoidance.driver import AvoidanceDriver
from controllers.avoidance.genetic import GeneticBudget, GeneticOptimiser, check_pymoo
from controllers.avoidance.settings import PaperSettings, driver_settings
from controllers.conflicts.velocity_obstacle import Cone
from controllers.driving.emergency_braking import EmergencyBraking
from controllers.interface import Controller
from controllers.prediction import named


def build(
    *,
    generations: int = 50,
    population: int = 50,
    replan_s: float = 1.0,
    euler_step_s: float = 1.0,
    euler_steps: int = 11,
    disc_radius_m: float = 2.0,
    cone: Cone = Cone.VO,
    truncation_s: float = float("inf"),
    steering_weight: float = 3282.8,
    top_speed_mps: float | None = None,
    standstill_gap_m: float = 2.5,
    headway_s: float = 1.0,
    lane_changes: bool = True,
    change_steps: int = 8,
    emergency_brake: bool = False,
    predictor: str = named.CONSTANT_VELOCITY,
    seed: int = 1,
) -> Controller:
    """Build the controller.

    Parameters
    ----------
    generations, population
        Budget of one solve: so many generations of so many plans are valued.
    replan_s
        A plan is followed for this long, less when somebody new is in conflict.
    euler_step_s, euler_steps
        Horizon; the vehicle moves in explicit Euler steps.
    disc_radius_m
        Of the disc about the body's centre that pedestrians' centres are kept out of. A smaller one than
        half the body's diagonal and his radius together, for a car about 2.67 m, leaves its corners out.
    cone
        ``vo``, ``ivo`` or ``hybrid``.
    truncation_s
        Who is farther away than the ego gets in this time does not count; inf for the paper's cone.
    steering_weight
        Of a change of the wheel angle in the objective, beside one of the speed [(m/s)^2/rad^2];
        3282.8 is one per square degree.
    top_speed_mps
        A plan may go up to this speed; none for the speed limit.
    standstill_gap_m, headway_s
        ``G_min = standstill_gap + headway * v``.
    lane_changes
        Whether to change lanes to avoid somebody.
    change_steps
        Steps that such a change takes.
    emergency_brake
        Whether an emergency brake has the last word along.
    predictor
        How pedestrians are expected to walk; one of ``controllers.prediction.named.names()``.
    seed
        Of the genetic algorithm, and of a predictor that draws random numbers.

    Raises
    ------
    ValueError
        If a parameter is out of range, there is no such predictor, or pymoo is not installed.
    """
    check_pymoo()
    for name, value, least in (("generations", generations, 1), ("population", population, 4)):
        if value < least:
            raise ValueError(f"{name} must be at least {least}, not {value}")
    settings = driver_settings(
        PaperSettings(
            replan_s=replan_s,
            euler_step_s=euler_step_s,
            euler_steps=euler_steps,
            disc_radius_m=disc_radius_m,
            cone=Cone(cone),
            truncation_s=truncation_s,
            steering_weight=steering_weight,
            top_speed_mps=top_speed_mps,
            standstill_gap_m=standstill_gap_m,
            headway_s=headway_s,
            lane_changes=lane_changes,
            change_steps=change_steps,
        )
    )
    return AvoidanceDriver(
        settings,
        GeneticOptimiser(GeneticBudget(generations, population), seed),
        named.sampled(predictor, seed=seed),
        EmergencyBraking() if emergency_brake else None,
    )
