"""Driving as the road and its vehicles demand: the basis of methods that control speed or steering alone.

Along the road: car-following with the Intelligent Driver Model, rules at junctions, bends and speed limits.
Across it: lane keeping, and lane changes that the route requires or that lead around slow and standing
vehicles. Pedestrians are not considered here; the methods themselves take care of them.
"""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.following import Following
from controllers.driving.lanes.lane_choice import LaneChoice
from controllers.interface import Decision, Manoeuvre, Perception

PAUSING = -3.0
"""Acceleration while a lane change that has begun is paused to let another vehicle past [m/s^2]."""


class TrafficDriver:
    """Follows other vehicles, and keeps or changes its lane for the route; one per ego, as it has memory."""

    def __init__(self, style: DrivingStyle | None = None) -> None:
        style = style or DrivingStyle()
        self._following = Following(style)
        self._lanes = LaneChoice(style=style)
        self._changing_to: int | None = None

    def decide(self, perception: Perception, threat: str = "") -> Decision:
        """Return which lane to be in; if there is a threat, its name is given as the reason."""
        target, reason = self._lanes.choose(perception)
        manoeuvre = self._manoeuvre(target, perception.road.reference)
        if not threat and not reason:
            reason = self._following.follow(perception, target, np.zeros(1)).because
        return Decision(manoeuvre, target, because=threat or reason)

    @property
    def waiting(self) -> bool:
        """Whether the ego wants another lane that is not free."""
        return self._lanes.waiting

    def accelerations(
        self, perception: Perception, decision: Decision, *, free_speed: float | None = None
    ) -> FloatArray:
        """Return the accelerations that traffic and road allow, at ``lane_keeping.instants(ego)`` [m/s^2].

        Parameters
        ----------
        perception, decision : as seen and decided
        free_speed : desired speed where nothing is ahead, instead of the speed limit here [m/s]
        """
        allowed = self._following.follow(
            perception,
            decision.target_lane,
            lane_keeping.instants(perception.ego),
            leaving=self._lanes.waiting,
            free_speed=free_speed,
        ).acceleration
        return np.minimum(allowed, PAUSING) if self._lanes.paused else allowed

    def outlook(self, perception: Perception, decision: Decision, times: FloatArray) -> FloatArray:
        """Return the accelerations allowed at other instants from now, ascending from 0 [m/s^2]."""
        return self._following.follow(
            perception, decision.target_lane, times, leaving=self._lanes.waiting
        ).acceleration

    def change_to(self, perception: Perception, number: int, because: str) -> None:
        """Begin a change to an adjacent lane that the method wants; the next decisions watch over it.

        Parameters
        ----------
        perception : as seen now
        number : ``Lane.number`` to end in
        because : the name to give as a reason
        """
        self._lanes.begin(perception, number, because)
        self._changing_to = number

    def steering(self, perception: Perception, decision: Decision, acceleration: FloatArray) -> FloatArray:
        """Return the front-wheel angles towards the target lane, at the same instants [rad]."""
        lane = perception.road.lane(decision.target_lane)
        return lane_keeping.steering(perception, lane.offset if lane else 0.0, acceleration)

    def _manoeuvre(self, target: int, reference: int) -> Manoeuvre:
        before, self._changing_to = self._changing_to, None if target == reference else target
        if target > reference:
            return Manoeuvre.CHANGE_LEFT
        if target < reference:
            return Manoeuvre.CHANGE_RIGHT
        return Manoeuvre.KEEP if before in (None, reference) else Manoeuvre.ABORT_CHANGE
