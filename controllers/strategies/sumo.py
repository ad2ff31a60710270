"""SUMO's own driver: the baseline that knows everything the simulation knows.

Both axes are driven by SUMO: its car-following and lane-change models, its junction and crossing rules.
"""

from __future__ import annotations

from controllers.interface import HAND_BACK, Controller, Decision, Manoeuvre, Perception, Plan


class SumoDriver:
    """Hands every step back to SUMO."""

    def decide(self, perception: Perception) -> Decision:
        """Hand back; the target lane is the one the ego is in."""
        return Decision(Manoeuvre.HAND_BACK, target_lane=perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the command that lets SUMO drive."""
        return Plan(HAND_BACK)


def build() -> Controller:
    """Build the controller; what SUMO's driver is like is set by its vehicle type."""
    return SumoDriver()
