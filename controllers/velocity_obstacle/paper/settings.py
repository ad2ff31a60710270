"""Settings that all controllers of the avoidance problem share, whatever their solver."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from controllers.prediction import by_name
from controllers.prediction.by_name import PredictorName
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.settings import ControllerSettings, NotNegative, Positive, PositiveOrInfinite, Unit
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.decision_rules import Reading
from controllers.velocity_obstacle.paper.driver import DriverSettings
from controllers.velocity_obstacle.paper.lane_rules import LAST_STEPS
from controllers.velocity_obstacle.paper.problem import InputLimits
from controllers.velocity_obstacle.paper.scene import SceneSettings


class PaperSettings(ControllerSettings):
    """The paper's formulation: explicit Euler steps of one second, objective (6), a cone at every step."""

    replan_s: Positive = 1.0
    """A plan is followed for this long, or less when another pedestrian comes into conflict."""
    euler_step_s: Positive = 1.0
    """Length of a step of the horizon; the vehicle moves in explicit Euler steps."""
    euler_steps: Annotated[int, Field(ge=2)] = 11
    """Steps of the horizon."""
    disc_radius_m: Positive = 2.0
    """Radius of the disc about the body's centre that pedestrians' centres are kept out of. A disc smaller
    than half the body's diagonal plus the pedestrian's radius, about 2.67 m for a car, leaves corners out."""
    cone: Literal[Cone.VO, Cone.IVO, Cone.HYBRID] = Cone.VO
    """Collision cone that relative velocities must not enter."""
    truncation_s: PositiveOrInfinite = float("inf")
    """Pedestrians farther away than the ego gets in this time are ignored; inf for the paper's cone."""
    steering_weight: Annotated[NotNegative, Unit("(m/s)²/rad²")] = 3282.8
    """Weight of a change of the wheel angle in the objective, relative to a change of speed; 3282.8 is one
    per square degree."""
    top_speed_mps: Positive | None = None
    """Highest speed of a plan; none for the speed limit."""
    standstill_gap_m: NotNegative = 2.5
    """Constant part of the least gap G_min = standstill_gap + headway · v."""
    headway_s: NotNegative = 1.0
    """Headway in the least gap, and time gap to a leader."""
    lane_changes: bool = True
    """Whether to change lanes to avoid pedestrians."""
    rules: Reading = Reading.ADAPTED
    """Conditions of the decision rules (26)-(31). adapted: one short gap in a lane is enough; printed: both
    gaps of a lane have to be short, as in the paper."""
    change_steps: int = 8
    """Steps that a lane change to avoid pedestrians takes."""
    emergency_brake: bool = False
    """Whether an emergency brake has the last word on the acceleration."""
    predictor: PredictorName = by_name.CONSTANT_VELOCITY
    """Model that predicts how pedestrians walk."""

    @model_validator(mode="after")
    def _fits_into_the_horizon(self) -> PaperSettings:
        horizon = self.euler_steps * self.euler_step_s
        if self.replan_s > horizon:
            raise ValueError(f"replan_s = {self.replan_s} is longer than the horizon of {horizon} s")
        if self.lane_changes and not LAST_STEPS <= self.change_steps <= self.euler_steps:
            raise ValueError(
                f"change_steps must be from {LAST_STEPS} to euler_steps = {self.euler_steps}, "
                f"not {self.change_steps}; or set lane_changes=false"
            )
        return self

    def driver(self) -> DriverSettings:
        """Return the settings of the driver."""
        scene = SceneSettings(
            step=self.euler_step_s,
            steps=self.euler_steps,
            radius=self.disc_radius_m,
            cone=self.cone,
            limits=InputLimits(),
            steering_weight=self.steering_weight,
            top_speed=self.top_speed_mps,
            standstill_gap=self.standstill_gap_m,
            headway=self.headway_s,
            truncation=self.truncation_s,
        )
        return DriverSettings(
            scene, self.replan_s, self.change_steps if self.lane_changes else None, self.rules
        )

    def brake(self) -> EmergencyBraking | None:
        """Return the emergency brake, if there is one."""
        return EmergencyBraking() if self.emergency_brake else None
