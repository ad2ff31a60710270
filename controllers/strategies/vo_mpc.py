"""Velocity-obstacle model predictive control: passing classes, decision rules, sequential QPs.

What its parameters mean; what it does with them is in ``controllers/mpc/driver.py`` and ``docs/control.md``,
with ``model=paper`` in ``controllers/avoidance/driver.py``.
"""

from __future__ import annotations

from controllers.avoidance.classes import QuadraticOptimiser
from controllers.avoidance.driver import AvoidanceDriver
from controllers.avoidance.settings import Model, PaperSettings, driver_settings
from controllers.conflicts import expectation
from controllers.conflicts.occlusion import HiddenPedestrian
from controllers.conflicts.velocity_obstacle import Cone
from controllers.driving.emergency_braking import EmergencyBraking
from controllers.driving.lane_choice import GapRule
from controllers.driving.lane_decision import ChangeSettings
from controllers.driving.unhurried import Unhurried
from controllers.interface import Controller
from controllers.mpc.driver import ConeParameters, Settings, Shape, VelocityObstacleMpc
from controllers.mpc.horizon import growing_grid
from controllers.mpc.lateral import SteeringWeights
from controllers.mpc.longitudinal import SpeedLimits, SpeedWeights
from controllers.mpc.passing_settings import PassingSettings
from controllers.optimisation.settings import SolverSettings
from controllers.prediction import named


def build(
    steps: int = 20,
    first_step_s: float = 0.1,
    last_step_s: float = 0.7,
    passes: int = 2,
    margin_along_m: float = 1.0,
    margin_across_m: float = 0.6,
    class_hysteresis: float = 0.85,
    class_lock_s: float = 2.5,
    max_classes: int = 3,
    reconsider_s: float = 0.3,
    standstill_gap_m: float = 2.5,
    headway_s: float = 1.0,
    lane_changes: bool = True,
    change_duration_s: float = 4.5,
    change_cost: float = 15.0,
    change_pause_s: float = 6.0,
    clear_before_crossing_m: float = 35.0,
    clear_after_crossing_m: float = 12.0,
    bend_acceleration_mps2: float = 2.0,
    max_acceleration_mps2: float = 2.2,
    comfortable_braking_mps2: float = 3.0,
    emergency_braking_mps2: float = 8.0,
    max_jerk_mps3: float = 12.0,
    freeze_braking_mps2: float = 7.0,
    yield_to_standing: bool = True,
    cone: Cone | None = None,
    shape: Shape = Shape.RECTANGLE,
    disc_radius_m: float = 2.0,
    truncation_s: float = float("inf"),
    solver: str | None = None,
    tolerance: float = 2e-4,
    model: Model = Model.CLOSED_LOOP,
    euler_step_s: float = 1.0,
    euler_steps: int = 11,
    euler_passes: int = 5,
    replan_s: float = 1.0,
    steering_weight: float = 3282.8,
    top_speed_mps: float | None = None,
    change_steps: int = 8,
    emergency_brake: bool = False,
    hidden_speed_mps: float = 1.5,
    hidden_reaction_s: float = 0.8,
    creep_mps: float = 2.0,
    uncertainty_gain: float = 1.0,
    idle_interval_s: float = 0.0,
    predictor: str = named.CONSTANT_VELOCITY,
    seed: int = 1,
) -> Controller:
    """Build the controller.

    Parameters
    ----------
    steps, first_step_s, last_step_s
        Horizon: number of intervals, first and last length; they grow geometrically.
    passes
        Quadratic programs per passing class at most.
    margin_along_m, margin_across_m
        Free distance to a pedestrian's disc along and across the path.
    class_hysteresis
        Another passing class is taken when it costs less than this share of the present one.
    class_lock_s
        Nearer than this to a pedestrian's path the class is kept.
    max_classes
        Passing classes solved per step.
    reconsider_s
        While the present class is reachable, other classes and other lanes are tried only this often.
    standstill_gap_m, headway_s
        ``G_min = standstill_gap + headway * v``.
    lane_changes
        Whether to change lanes at all.
    change_duration_s, change_cost, change_pause_s
        Length of a change, what it costs in the objective, and the pause after one.
    clear_before_crossing_m, clear_after_crossing_m
        No change begins within this distance of a crossing, but for one that the route asks for.
    bend_acceleration_mps2
        Comfortable lateral acceleration.
    max_acceleration_mps2, comfortable_braking_mps2, emergency_braking_mps2, max_jerk_mps3
        Limits of the plan; braking beyond the comfortable limit is penalised.
    freeze_braking_mps2
        Braking with which the ego must still be able to stop should a pedestrian stop in its path.
    yield_to_standing
        Expect people who stand at the kerb of a zebra to step out.
    cone
        ``step`` keeps positions apart and steers for the lane alone; ``vo``, ``ivo`` and ``hybrid`` keep
        relative velocities out of collision cones, by speed and steering together. None is ``step``, with
        ``model=paper`` it is ``vo``.
    shape, disc_radius_m
        What those cones enclose: the body grown by the margins, or a disc of this radius about its centre,
        pedestrian included; one of less than some 2.7 m leaves out the corners of a car.
    truncation_s
        Time within which a collision course counts for those cones; inf for the paper's infinite cone.
    solver, tolerance
        A solver that qpsolvers knows, None for ``daqp``, with ``model=paper`` for ``osqp``; the tolerance is
        OSQP's, the others keep their own. ``run.json`` says which one ran.
    model
        ``closed_loop``, or ``paper`` for the formulation of the paper. That one takes the parameters from
        here on, and of those above ``cone`` (about a disc of ``disc_radius_m``), ``truncation_s``,
        ``max_classes``, ``lane_changes``, ``standstill_gap_m``, ``headway_s``, ``solver``, ``tolerance``.
    euler_step_s, euler_steps
        Horizon; the vehicle moves in explicit Euler steps.
    euler_passes
        Quadratic programs per passing class at most.
    replan_s
        A plan is followed for this long, less when somebody new is in conflict.
    steering_weight
        Of a change of the wheel angle in the objective, beside one of the speed [(m/s)^2/rad^2];
        3282.8 is one per square degree.
    top_speed_mps
        A plan may go up to this speed; none for the speed limit.
    change_steps
        Steps that a change of lane takes which is to avoid somebody.
    emergency_brake
        Whether an emergency brake has the last word along.
    hidden_speed_mps, hidden_reaction_s, creep_mps
        Somebody who cannot be seen behind a standing vehicle may step out with this speed; what the ego takes
        to brake for him; the speed below which it need not be for his sake. With a speed of 0 nobody is
        expected. Only with sensing that is not perfect, and not with ``model=paper``.
    uncertainty_gain
        What both margins grow by for each metre that a pedestrian's position is uncertain (standard
        deviation); 0 for not at all. Not with ``model=paper``.
    idle_interval_s
        Time between plans while nobody is near and the road goes straight on, see
        :mod:`controllers.driving.unhurried`; 0 to plan at every step. Not with ``model=paper``.
    predictor
        How pedestrians are expected to walk; one of ``controllers.prediction.named.names()``.
    seed
        Of a predictor that draws random numbers.

    Raises
    ------
    ValueError
        If a parameter is out of range, or there is no such predictor.
    """
    if steps < 2:
        raise ValueError(f"steps must be at least 2, not {steps}")
    if not 0.0 < first_step_s <= last_step_s:
        raise ValueError(f"first_step_s must be above 0 and at most last_step_s, not {first_step_s}")
    not_negative = {
        "margin_along_m": margin_along_m,
        "margin_across_m": margin_across_m,
        "standstill_gap_m": standstill_gap_m,
        "headway_s": headway_s,
        "class_lock_s": class_lock_s,
        "change_cost": change_cost,
        "hidden_speed_mps": hidden_speed_mps,
        "hidden_reaction_s": hidden_reaction_s,
        "uncertainty_gain": uncertainty_gain,
    }
    above_zero = {
        "disc_radius_m": disc_radius_m,
        "truncation_s": truncation_s,
        "tolerance": tolerance,
        "change_duration_s": change_duration_s,
        "bend_acceleration_mps2": bend_acceleration_mps2,
        "max_acceleration_mps2": max_acceleration_mps2,
        "comfortable_braking_mps2": comfortable_braking_mps2,
        "emergency_braking_mps2": emergency_braking_mps2,
        "max_jerk_mps3": max_jerk_mps3,
        "freeze_braking_mps2": freeze_braking_mps2,
        "creep_mps": creep_mps,
    }
    for name, value in not_negative.items():
        if not 0.0 <= value < float("inf"):
            raise ValueError(f"{name} must be at least 0 and finite, not {value}")
    for name, value in above_zero.items():
        if not value > 0.0:
            raise ValueError(f"{name} must be above 0, not {value}")
    paper = Model(model) is Model.PAPER
    solving = SolverSettings(solver or ("osqp" if paper else "daqp"), tolerance)
    if paper:
        if euler_passes < 1:
            raise ValueError(f"euler_passes must be at least 1, not {euler_passes}")
        return AvoidanceDriver(
            driver_settings(
                PaperSettings(
                    replan_s=replan_s,
                    euler_step_s=euler_step_s,
                    euler_steps=euler_steps,
                    disc_radius_m=disc_radius_m,
                    cone=Cone(cone or Cone.VO),
                    truncation_s=truncation_s,
                    steering_weight=steering_weight,
                    top_speed_mps=top_speed_mps,
                    standstill_gap_m=standstill_gap_m,
                    headway_s=headway_s,
                    lane_changes=lane_changes,
                    change_steps=change_steps,
                )
            ),
            QuadraticOptimiser(euler_passes, max(max_classes, 1), solving),
            named.sampled(predictor, seed=seed),
            EmergencyBraking() if emergency_brake else None,
        )
    driver = VelocityObstacleMpc(
        Settings(
            dt=growing_grid(steps, first_step_s, last_step_s),
            passing=PassingSettings(
                margin_along=margin_along_m,
                margin_across=margin_across_m,
                hysteresis=class_hysteresis,
                lock=class_lock_s,
                max_classes=max(max_classes, 1),
                passes=max(passes, 1),
                reconsider=reconsider_s,
                standstill_gap=standstill_gap_m,
                bend_acceleration=bend_acceleration_mps2,
                assume=expectation.PedestrianAssumptions(yield_to_standing=yield_to_standing),
                hidden=HiddenPedestrian(hidden_speed_mps, hidden_reaction_s, freeze_braking_mps2, creep_mps),
                uncertainty_gain=uncertainty_gain,
            ),
            cone=ConeParameters(Cone(cone or Cone.STEP), Shape(shape), disc_radius_m, truncation_s),
            change=ChangeSettings(
                allowed=lane_changes,
                cost=change_cost,
                pause=change_pause_s,
                reconsider=reconsider_s,
                before_crossing=clear_before_crossing_m,
                after_crossing=clear_after_crossing_m,
                least_speed=2.0,
                room=12.0,
                standstill_gap=standstill_gap_m,
                headway=headway_s,
                gaps=GapRule(minimum=standstill_gap_m, headway=headway_s, duration=change_duration_s),
            ),
            change_duration=change_duration_s,
            weights=SpeedWeights(),
            limits=SpeedLimits(
                acceleration=max_acceleration_mps2,
                comfortable_braking=comfortable_braking_mps2,
                emergency_braking=emergency_braking_mps2,
                jerk=max_jerk_mps3,
                freeze_braking=freeze_braking_mps2,
                headway=headway_s,
            ),
            steering=SteeringWeights(),
            solver=solving,
        ),
        named.sampled(predictor, seed=seed),
    )
    return driver if idle_interval_s == 0.0 else Unhurried(driver, idle_interval_s)
