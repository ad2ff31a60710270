"""Settings that all controllers with speed plans share."""

from __future__ import annotations

from pydantic import model_validator

from controllers.driving.driving_style import DrivingStyle
from controllers.prediction import by_name
from controllers.prediction.by_name import PredictorName
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.settings import ControllerSettings, NotNegative, Positive, PositiveOrInfinite
from controllers.speed_plans.speed_targets import CrossingRule
from controllers.speed_plans.trapezoid_profile import PlanningLimits

LIMITS = PlanningLimits()
BRISK = 1.8
"""The ego follows traffic with at least this acceleration, however gentle the plans are [m/s^2]."""


class SpeedPlanSettings(ControllerSettings):
    """Limits of the plans, and how the ego lets pedestrians go first."""

    acceleration_mps2: Positive = LIMITS.acceleration
    """Acceleration of a normal plan."""
    deceleration_mps2: Positive = 2.0
    """Deceleration of a normal plan."""
    emergency_deceleration_mps2: Positive = LIMITS.emergency_deceleration
    """Largest deceleration in an emergency."""
    max_speed_mps: PositiveOrInfinite = float("inf")
    """Top speed, driven where the road allows it."""
    actuator_delay_s: NotNegative = LIMITS.actuator_delay
    """α, time from a command to its effect, drive lag included; what exceeds the lag counts as dead time."""
    standoff_m: NotNegative = LIMITS.standoff
    """d_extra, distance left to an obstacle after a stop."""
    period_s: PositiveOrInfinite = 0.1
    """Time between two plans; if it is shorter than the time between perceptions, each gets a plan."""
    time_margin_s: NotNegative = 1.0
    """The ego goes ahead of a pedestrian who comes into its way at least this long after it is past."""
    side_margin_m: NotNegative = 0.6
    """Distance by which a pedestrian's disc is enlarged across the ego's way."""
    emergency_brake: bool = True
    """Whether automatic emergency braking, as in aeb, acts for road users without a plan."""
    predictor: PredictorName = by_name.CONSTANT_VELOCITY
    """Model that predicts how pedestrians walk."""

    @model_validator(mode="after")
    def _emergencies_are_not_gentler(self) -> SpeedPlanSettings:
        if self.emergency_deceleration_mps2 < self.deceleration_mps2:
            raise ValueError(
                f"emergency_deceleration_mps2 = {self.emergency_deceleration_mps2} must be at least "
                f"deceleration_mps2 = {self.deceleration_mps2}"
            )
        return self

    def limits(self) -> PlanningLimits:
        """Return the limits of a plan."""
        return PlanningLimits(
            self.acceleration_mps2,
            self.deceleration_mps2,
            self.emergency_deceleration_mps2,
            self.max_speed_mps,
            self.actuator_delay_s,
            self.standoff_m,
        )

    def style(self) -> DrivingStyle:
        """Return how traffic is followed."""
        return DrivingStyle(standstill_gap=self.standoff_m, acceleration=max(self.acceleration_mps2, BRISK))

    def crossing_rule(self) -> CrossingRule:
        """Return when to go ahead of a pedestrian, and where to stop for one."""
        return CrossingRule(self.standoff_m, side_margin=self.side_margin_m, time_margin=self.time_margin_s)

    def brake(self) -> EmergencyBraking | None:
        """Return the emergency brake, if there is one."""
        return EmergencyBraking() if self.emergency_brake else None
