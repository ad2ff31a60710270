"""A driver blind to pedestrians, with automatic emergency braking: the baseline of the drivable-area paper.

Along: car-following that obeys leaders, signals, right of way, speed limits and bends, but yields to no
pedestrian, not at a zebra either; emergency braking for pedestrians and vehicles that would be met should
they keep their velocities, or should people walk as another predictor says. Across: lane keeping, and lane
changes that the route asks for or that lead around slow and standing vehicles, into gaps that stay safe.
"""

from __future__ import annotations

import numpy as np

from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.emergency_braking import BrakingRule, EmergencyBraking
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Controller, Decision, Perception, Plan
from controllers.prediction import named
from controllers.prediction.forecast import Predictor


class EmergencyBrakingDriver:
    """Follows, keeps or changes its lane for the route, and brakes in an emergency."""

    def __init__(self, style: DrivingStyle, rule: BrakingRule, predictor: Predictor | None) -> None:
        self._traffic = TrafficDriver(style)
        self._brake = EmergencyBraking(rule, predictor)

    def decide(self, perception: Perception) -> Decision:
        """Say which lane to be in, and who is braked or waited for."""
        return self._traffic.decide(perception, self._brake.watch(perception))

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive towards the target lane; the emergency brake has the last word along."""
        times = lane_keeping.instants(perception.ego)
        allowed = self._traffic.accelerations(perception, decision)
        acceleration = np.minimum(allowed, self._brake.accelerations(perception.ego, times))
        return Plan(Command(times, acceleration, self._traffic.steering(perception, decision, acceleration)))


def build(
    *,
    friction: float = 0.8,
    dead_time_s: float = 0.1,
    ramp_s: float = 0.2,
    stop_margin_m: float = 0.5,
    side_margin_m: float = 0.1,
    headway_s: float = 1.0,
    predictor: str = named.CONSTANT_VELOCITY,
    seed: int = 1,
) -> Controller:
    """Build the controller.

    Parameters
    ----------
    friction : float
        Full braking is friction · g, or what the drive can do if that is less.
    dead_time_s : float
        From the trigger until the brake begins to act [s].
    ramp_s : float
        From then until it brakes fully; the deceleration grows linearly [s].
    stop_margin_m : float
        Distance that is to be left after a stop; larger means earlier [m].
    side_margin_m : float
        What a pedestrian's disc is grown by in the prediction [m].
    headway_s : float
        Time gap to a leader [s].
    predictor : str
        How pedestrians are expected to walk; one of ``controllers.prediction.named.names()``.
    seed : int
        Of a predictor that draws random numbers.

    Raises
    ------
    ValueError
        If one is negative or not finite, the friction is zero, or there is no such predictor.
    """
    for name, value in {
        "friction": friction,
        "dead_time_s": dead_time_s,
        "ramp_s": ramp_s,
        "stop_margin_m": stop_margin_m,
        "side_margin_m": side_margin_m,
        "headway_s": headway_s,
    }.items():
        if not 0.0 <= value < float("inf"):
            raise ValueError(f"{name} = {value} must be at least 0 and finite")
    if friction == 0.0:
        raise ValueError("friction = 0.0 must be greater than 0")
    rule = BrakingRule(friction, dead_time_s, ramp_s, stop_margin_m, side_margin_m)
    style = DrivingStyle(headway=headway_s)
    return EmergencyBrakingDriver(style, rule, named.sampled(predictor, seed=seed))
