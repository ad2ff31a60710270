"""A driver blind to pedestrians, with automatic emergency braking: the baseline of the drivable-area paper.

Along: car-following that obeys leaders, signals, right of way, speed limits and bends, but yields to no
pedestrian, not even at a zebra; emergency braking for pedestrians and vehicles that the ego would meet if
they kept their velocities, or if people walked as another predictor says. Across: lane keeping, and lane
changes that the route requires or that lead around slow and standing vehicles, into gaps that stay safe.
"""

from __future__ import annotations

import numpy as np

from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Controller, Decision, Perception, Plan
from controllers.own_part import OwnPart, differ
from controllers.prediction import by_name
from controllers.prediction.by_name import PredictorName
from controllers.prediction.forecast import Predictor
from controllers.safety.emergency_braking import BrakingRule, EmergencyBraking
from controllers.settings import ControllerSettings, NotNegative, Positive


class EmergencyBrakingDriver:
    """Follows, keeps or changes its lane for the route, and brakes in an emergency."""

    def __init__(self, style: DrivingStyle, rule: BrakingRule, predictor: Predictor | None) -> None:
        self._traffic = TrafficDriver(style)
        self._brake = EmergencyBraking(rule, predictor)
        self._threat = ""

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in, and for whom the ego brakes or waits."""
        self._threat = self._brake.watch(perception)
        return self._traffic.decide(perception, self._threat)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive towards the target lane; the emergency brake has the last word on the acceleration."""
        times = lane_keeping.instants(perception.ego)
        allowed = self._traffic.accelerations(perception, decision)
        acceleration = np.minimum(allowed, self._brake.accelerations(perception.ego, times))
        command = Command(times, acceleration, self._traffic.steering(perception, decision, acceleration))
        someone = self._threat in perception.pedestrians.names
        return Plan(command, own=OwnPart(someone, someone, someone and differ(acceleration, allowed)))


RULE = BrakingRule()


class Settings(ControllerSettings):
    """The parameters of the controller."""

    friction: Positive = RULE.friction
    """Full braking is friction · g, or what the drive can do if that is less."""
    dead_time_s: NotNegative = RULE.dead_time
    """Time from the trigger until the brake begins to act."""
    ramp_s: NotNegative = RULE.ramp
    """Time from then until full braking; the deceleration grows linearly."""
    stop_margin_m: NotNegative = RULE.stop_margin
    """Distance to be left after a stop; a larger one makes the brake act earlier."""
    side_margin_m: NotNegative = RULE.side_margin
    """Distance by which a pedestrian's disc is enlarged in the prediction."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""
    predictor: PredictorName = by_name.CONSTANT_VELOCITY
    """Model that predicts how pedestrians walk."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    rule = BrakingRule(
        settings.friction,
        settings.dead_time_s,
        settings.ramp_s,
        settings.stop_margin_m,
        settings.side_margin_m,
    )
    predictor = by_name.sampled(settings.predictor, seed=settings.seed)
    return EmergencyBrakingDriver(DrivingStyle(headway=settings.headway_s), rule, predictor)
