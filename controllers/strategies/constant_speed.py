"""Keeps its speed and its lane whatever happens: the scripted car of test protocols.

Along: the given speed, or the speed at the first step. Across: lane keeping in the lane where the ego began;
it follows bends but brakes for nothing and nobody, not even for a bend that is too tight.
"""

from __future__ import annotations

import numpy as np

from controllers.driving import lane_keeping
from controllers.interface import Command, Controller, Decision, EgoState, Manoeuvre, Perception, Plan
from controllers.settings import ControllerSettings, NotNegative

RESPONSE_TIME = 0.5
"""Time constant with which a wrong speed is corrected, in addition to the plan interval [s]."""


class ConstantSpeed:
    """Holds one speed in one lane.

    Parameters
    ----------
    speed : speed to hold; ``None`` for the speed at the first step [m/s]
    """

    def __init__(self, speed: float | None) -> None:
        self._speed = speed
        self._lane: int | None = None

    def decide(self, perception: Perception) -> Decision:
        """Keep the first lane, as long as there is such a lane."""
        if self._speed is None:
            self._speed = perception.ego.speed
        if self._lane is None or perception.road.lane(self._lane) is None:
            self._lane = perception.road.reference
        return Decision(Manoeuvre.KEEP, target_lane=self._lane)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Correct the speed and the position in the lane."""
        ego = perception.ego
        lane = perception.road.lane(decision.target_lane)
        acceleration = np.full(len(lane_keeping.instants(ego)), self._acceleration(ego))
        angles = lane_keeping.steering(perception, lane.offset if lane else 0.0, acceleration)
        return Plan(Command(lane_keeping.instants(ego), acceleration, angles))

    def _acceleration(self, ego: EgoState) -> float:
        wanted = ego.speed if self._speed is None else self._speed
        asked = (wanted - ego.speed) / (RESPONSE_TIME + ego.plan_interval)
        return min(max(asked, -ego.drive.max_deceleration), ego.drive.max_acceleration)


class Settings(ControllerSettings):
    """The parameters of the controller."""

    speed_mps: NotNegative | None = None
    """Speed to hold; none keeps the speed at which the ego was taken over."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    return ConstantSpeed(settings.speed_mps)
