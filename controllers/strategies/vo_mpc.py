"""Velocity-obstacle model predictive control: passing classes, decision rules, sequential QPs.

This module explains the parameters; ``controllers/velocity_obstacle/mpc/driver.py`` and ``docs/control.md``
explain what the controller does with them. The formulation of the paper is ``vo_paper``.
"""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from controllers.conflicts.expected_behaviour import PedestrianAssumptions
from controllers.conflicts.hidden_pedestrians import HiddenPedestrian
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.lanes.gap_acceptance import GapRule
from controllers.interface import Controller
from controllers.optimisation.settings import SolverSettings
from controllers.prediction import by_name
from controllers.prediction.by_name import PredictorName
from controllers.settings import AtLeastOne, ControllerSettings, NotNegative, Positive, PositiveOrInfinite
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.mpc import driver
from controllers.velocity_obstacle.mpc.driver import ConeParameters, Shape, VelocityObstacleMpc
from controllers.velocity_obstacle.mpc.horizon import growing_grid
from controllers.velocity_obstacle.mpc.idle_planning import LONGEST, Unhurried
from controllers.velocity_obstacle.mpc.lane_by_cost import ChangeSettings
from controllers.velocity_obstacle.mpc.lateral import SteeringWeights
from controllers.velocity_obstacle.mpc.longitudinal import SpeedLimits, SpeedWeights
from controllers.velocity_obstacle.mpc.passing_settings import PassingSettings

HIDDEN = HiddenPedestrian(speed=1.5)
LIMITS = SpeedLimits()
SLOWEST_CHANGE = 2.0
"""Lanes are not changed below this speed [m/s]."""
ROOM_AT_LANE_END = 12.0
"""Length kept free before the end of a lane that has to be left [m]."""


class Settings(ControllerSettings):
    """The parameters of the controller."""

    moved: ClassVar = {
        "model": "vo_mpc is the closed-loop formulation; that of the paper is --controller vo_paper"
    }

    steps: Annotated[int, Field(ge=2)] = 20
    """Intervals of the horizon; they grow geometrically."""
    first_step_s: Positive = 0.1
    """Length of the first interval."""
    last_step_s: Positive = 0.7
    """Length of the last interval."""
    passes: AtLeastOne = 2
    """Largest number of quadratic programs per passing class."""
    margin_along_m: NotNegative = 1.0
    """Free distance to a pedestrian's disc along the path."""
    margin_across_m: NotNegative = 0.6
    """Free distance to a pedestrian's disc across the path."""
    class_hysteresis: Positive = 0.85
    """The ego switches to another passing class if it costs less than this share of the present one."""
    class_lock_s: NotNegative = 2.5
    """The class is kept once the ego is this close in time to a pedestrian in conflict."""
    max_classes: AtLeastOne = 3
    """Largest number of passing classes solved per step."""
    reconsider_s: NotNegative = 0.3
    """Interval at which other lanes and, while the present class is reachable, other classes are tried."""
    standstill_gap_m: NotNegative = 2.5
    """Constant part of the least gap G_min = standstill_gap + headway · v."""
    headway_s: NotNegative = 1.0
    """Headway in the least gap, and time gap to a leader."""
    lane_changes: bool = True
    """Whether to change lanes at all."""
    change_duration_s: Positive = 4.5
    """Duration of a lane change."""
    change_cost: NotNegative = 15.0
    """Cost of a lane change in the objective."""
    change_cost_near_crossing: PositiveOrInfinite = float("inf")
    """Cost of a lane change that begins near a crossing because of people on it. It has to end before the
    crossing, and no vehicle may be in either lane up to 15 m beyond it, so that nobody is masked; inf: no
    change begins there."""
    change_pause_s: NotNegative = 6.0
    """Least time between two lane changes that the route does not require."""
    clear_before_crossing_m: NotNegative = 35.0
    """No lane change begins nearer than this before a crossing, unless the route requires it."""
    clear_after_crossing_m: NotNegative = 12.0
    """No lane change begins nearer than this after a crossing, unless the route requires it."""
    bend_acceleration_mps2: PositiveOrInfinite = DrivingStyle().lateral_acceleration
    """Comfortable lateral acceleration in bends."""
    max_acceleration_mps2: PositiveOrInfinite = 2.2
    """Largest acceleration of a plan."""
    comfortable_braking_mps2: PositiveOrInfinite = LIMITS.comfortable_braking
    """Deceleration above this is penalised."""
    emergency_braking_mps2: PositiveOrInfinite = LIMITS.emergency_braking
    """Hardest braking of a plan."""
    max_jerk_mps3: PositiveOrInfinite = LIMITS.jerk
    """Largest jerk of a plan."""
    freeze_braking_mps2: PositiveOrInfinite = LIMITS.freeze_braking
    """Deceleration with which the ego must still be able to stop if a pedestrian stops in its path."""
    yield_to_standing: bool = True
    """Whether to expect that people who stand at the kerb of a zebra step out."""
    courtesy_s: NotNegative = 1.0
    """At rest before a crossing without priority, the ego lets people who stand at its end go first, until
    they have not stepped onto it for this long."""
    cone: Cone = Cone.STEP
    """step keeps positions apart and steers only to keep the lane; the others keep relative velocities out of
    collision cones, by speed and steering combined."""
    shape: Shape = Shape.RECTANGLE
    """Shape that those cones enclose: the body enlarged by the margins, or a disc around its centre."""
    disc_radius_m: PositiveOrInfinite = 2.0
    """Radius of that disc, pedestrian included; less than about 2.7 m leaves out the corners of a car."""
    truncation_s: PositiveOrInfinite = float("inf")
    """Time within which a collision course counts for those cones; inf for the paper's infinite cone."""
    solver: str = "daqp"
    """A solver that qpsolvers knows and that is installed; run.json says which one ran."""
    tolerance: PositiveOrInfinite = 2e-4
    """Tolerance of OSQP; other solvers keep their own."""
    hidden_speed_mps: NotNegative = HIDDEN.speed
    """Speed with which a pedestrian hidden behind a standing vehicle may step out; 0: nobody is expected. It
    matters only with sensing that is not perfect."""
    hidden_reaction_s: NotNegative = HIDDEN.reaction
    """Time that the ego takes to brake for a hidden pedestrian."""
    creep_mps: PositiveOrInfinite = HIDDEN.creep
    """The ego need not be slower than this, however near a pedestrian may be hidden."""
    uncertainty_gain: NotNegative = 1.0
    """Growth of both margins per metre of standard deviation of a pedestrian's position; 0 for none."""
    idle_interval_s: Annotated[float, Field(ge=0.0, le=LONGEST)] = 0.0
    """Time between two plans while nobody near could change them; 0 to plan at every step."""
    predictor: PredictorName = by_name.CONSTANT_VELOCITY
    """Model that predicts how pedestrians walk."""

    @model_validator(mode="after")
    def _steps_grow(self) -> Settings:
        if self.first_step_s > self.last_step_s:
            raise ValueError(
                f"first_step_s = {self.first_step_s} must be at most last_step_s = {self.last_step_s}"
            )
        return self

    @model_validator(mode="after")
    def _emergency_brakes_hardest(self) -> Settings:
        if self.emergency_braking_mps2 < self.comfortable_braking_mps2:
            raise ValueError(
                f"emergency_braking_mps2 = {self.emergency_braking_mps2} must be at least "
                f"comfortable_braking_mps2 = {self.comfortable_braking_mps2}"
            )
        return self


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If there is no such solver.
    """
    cone = ConeParameters(settings.cone, settings.shape, settings.disc_radius_m, settings.truncation_s)
    made = VelocityObstacleMpc(
        driver.Settings(
            dt=growing_grid(settings.steps, settings.first_step_s, settings.last_step_s),
            passing=_passing(settings),
            cone=cone,
            change=_change(settings),
            change_duration=settings.change_duration_s,
            weights=SpeedWeights(),
            limits=_limits(settings),
            steering=SteeringWeights(),
            solver=SolverSettings(settings.solver, settings.tolerance),
        ),
        by_name.sampled(settings.predictor, seed=settings.seed),
    )
    if settings.idle_interval_s == 0.0:
        return made
    return Unhurried(made, settings.idle_interval_s, settings.predictor == by_name.CONSTANT_VELOCITY)


def _passing(settings: Settings) -> PassingSettings:
    return PassingSettings(
        margin_along=settings.margin_along_m,
        margin_across=settings.margin_across_m,
        hysteresis=settings.class_hysteresis,
        lock=settings.class_lock_s,
        max_classes=settings.max_classes,
        passes=settings.passes,
        reconsider=settings.reconsider_s,
        standstill_gap=settings.standstill_gap_m,
        bend_acceleration=settings.bend_acceleration_mps2,
        assume=PedestrianAssumptions(
            yield_to_standing=settings.yield_to_standing, courtesy=settings.courtesy_s
        ),
        hidden=HiddenPedestrian(
            settings.hidden_speed_mps,
            settings.hidden_reaction_s,
            settings.freeze_braking_mps2,
            settings.creep_mps,
        ),
        uncertainty_gain=settings.uncertainty_gain,
    )


def _change(settings: Settings) -> ChangeSettings:
    gap, headway = settings.standstill_gap_m, settings.headway_s
    return ChangeSettings(
        allowed=settings.lane_changes,
        cost=settings.change_cost,
        pause=settings.change_pause_s,
        reconsider=settings.reconsider_s,
        before_crossing=settings.clear_before_crossing_m,
        after_crossing=settings.clear_after_crossing_m,
        least_speed=SLOWEST_CHANGE,
        room=ROOM_AT_LANE_END,
        standstill_gap=gap,
        headway=headway,
        gaps=GapRule(minimum=gap, headway=headway, duration=settings.change_duration_s),
        cost_near_crossing=settings.change_cost_near_crossing,
    )


def _limits(settings: Settings) -> SpeedLimits:
    return SpeedLimits(
        acceleration=settings.max_acceleration_mps2,
        comfortable_braking=settings.comfortable_braking_mps2,
        emergency_braking=settings.emergency_braking_mps2,
        jerk=settings.max_jerk_mps3,
        freeze_braking=settings.freeze_braking_mps2,
        headway=settings.headway_s,
    )
