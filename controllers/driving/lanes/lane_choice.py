"""The lane that any driver chooses: the one that the route requires, or else a better one, if it is free.

The wanted lane is remembered by ``Lane.number``, which does not change when the ego moves over and another
lane becomes its reference lane.
"""

from __future__ import annotations

import numpy as np

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.lanes.gap_acceptance import GapRule, blocker
from controllers.driving.lanes.lane_for_route import RouteRule, lane_for_route, leads_off_now
from controllers.driving.lanes.lane_incentive import IncentiveRule, better_lane
from controllers.driving.leaders import LANE_END
from controllers.interface import Perception


class LaneChoice:
    """Chooses the lane to be in, for the route or because it is better; one per ego, as it has memory."""

    def __init__(
        self,
        gap_rule: GapRule | None = None,
        route_rule: RouteRule | None = None,
        incentive_rule: IncentiveRule | None = None,
        style: DrivingStyle | None = None,
    ) -> None:
        self._gap_rule = gap_rule or GapRule()
        self._route_rule = route_rule or RouteRule()
        self._incentive_rule = incentive_rule or IncentiveRule()
        self._style = style or DrivingStyle()
        self._target: int | None = None
        self._because = ""
        self._last_change = -np.inf
        self.waiting = False
        """Whether the ego wants another lane that is not free."""
        self.paused = False
        """Whether a change that has begun is paused until another vehicle is past."""

    def choose(self, perception: Perception) -> tuple[int, str]:
        """Return the ``Lane.number`` to end in, and the reason.

        The reason is ``lane end`` if the route requires a change, the leader if the change is to get away
        from it, or the name of the vehicle that blocks the change or made the ego give it up. It is empty if
        no change is wanted.
        """
        road = perception.road
        self.waiting = self.paused = False
        if self._target is None or road.lane(self._target) is None:
            self._target = road.reference
        if leads_off_now(perception, self._target):
            self._target = road.reference
        if self._target != road.reference:
            threat = blocker(perception, self._target, self._gap_rule, begun=True)
            if threat is not None and perception.ego.speed < self._gap_rule.pause_below:
                self.paused = True
                return self._target, threat
            if threat is not None:
                self._target = road.reference
                return self._target, threat
            self._last_change = perception.ego.time
            return self._target, self._because
        wanted, because = self._wanted(perception)
        if wanted is None:
            return self._target, ""
        threat = blocker(perception, wanted, self._gap_rule)
        if threat is not None:
            self.waiting = True
            return self._target, threat
        self._target, self._because, self._last_change = wanted, because, perception.ego.time
        return self._target, because

    def begin(self, perception: Perception, number: int, because: str) -> None:
        """Begin a change to an adjacent lane for the method's own reason; ``choose`` then continues it."""
        self._target, self._because, self._last_change = number, because, perception.ego.time

    def _wanted(self, perception: Perception) -> tuple[int | None, str]:
        for_route = lane_for_route(perception, self._route_rule)
        if for_route is not None:
            return for_route, LANE_END
        if perception.ego.time < self._last_change + self._incentive_rule.pause:
            return None, ""
        ahead = perception.gaps.ahead
        return better_lane(perception, self._style, self._incentive_rule), ahead.name if ahead else ""
