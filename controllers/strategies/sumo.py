"""SUMO's own driver: the baseline that knows everything the simulation knows.

Both axes are driven by SUMO: its car-following and lane-change models, its junction and crossing rules.
"""

from __future__ import annotations

from controllers.interface import HAND_BACK, Controller, Decision, Manoeuvre, Perception, Plan
from controllers.settings import ControllerSettings


class SumoDriver:
    """Hands every step back to SUMO."""

    def decide(self, perception: Perception) -> Decision:
        """Hand the step back to SUMO; the target lane is the one the ego is in."""
        return Decision(Manoeuvre.HAND_BACK, target_lane=perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the command that lets SUMO drive."""
        return Plan(HAND_BACK)


class Settings(ControllerSettings):
    """No parameters: SUMO's driver follows from its vehicle type."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    return SumoDriver()
