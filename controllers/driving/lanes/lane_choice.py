"""Which lane to be in so that the route can be followed, and whether another lane is free.

The lane wanted is remembered by ``Lane.number``, which does not change while the ego moves over and its
reference lane becomes another one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.lanes.lane_incentive import IncentiveRule, better_lane
from controllers.driving.leaders import LANE_END
from controllers.interface import Lane, Neighbour, NeighbourGaps, Perception, RoadAhead

SAME_END = 10.0
"""Lanes whose ends differ by less end at the same place: in a bend their lengths differ [m]."""


@dataclass(frozen=True, slots=True)
class GapRule:
    """When the gaps of another lane are large enough.

    At the beginning each gap must be at least G_min = minimum + headway · v plus what braking from the
    closing speed needs; later in the manoeuvre it must stay above a share of G_min.
    """

    minimum: float = 2.5
    """Gap at standstill [m]."""
    headway: float = 1.0
    """Time gap of the one behind [s]."""
    deceleration: float = 2.0
    """With which a closing speed is reduced [m/s^2]."""
    duration: float = 4.0
    """How far ahead others are predicted, at constant velocity [s]."""
    later_share: float = 0.5
    """Share of G_min that must be left at any time of the manoeuvre."""
    abort_share: float = 0.3
    """Share of G_min below which a change that has begun is given up …"""
    abort_deceleration: float = 4.0
    """… beside what the one behind needs to brake down with this [m/s^2]."""
    abort_duration: float = 1.0
    """How far ahead others are predicted once a change has begun: by then they see it [s]."""
    pause_below: float = 3.0
    """So slow, a change is not given up but paused: there is no room to steer back [m/s]."""
    side: float = 0.3
    """Distance kept beside others [m]."""


@dataclass(frozen=True, slots=True)
class RouteRule:
    """When a lane has to be left for the route."""

    distance: float = 60.0
    """Distance that a lane change takes at least [m]."""
    time: float = 5.0
    """Time that a lane change takes at least [s]."""
    search: float = 1.0
    """How much more of the same to allow for finding a gap."""


class LaneChoice:
    """Chooses the lane to be in, for the route or because it is better there. One per ego: it remembers."""

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
        """Whether another lane is wanted that is not free."""
        self.paused = False
        """Whether a change that has begun has to stand still until somebody is past."""

    def choose(self, perception: Perception) -> tuple[int, str]:
        """Return the ``Lane.number`` to end in, and because of what.

        The reason is ``lane end`` where the route asks for a change, the leader where the change is to get
        away from it, the name of a vehicle that blocks the change or for which it was given up, and empty
        where there is nothing to change.
        """
        road = perception.road
        self.waiting = self.paused = False
        if self._target is None or road.lane(self._target) is None:
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
        """Begin a change to an adjacent lane for a reason of the method's own; ``choose`` goes on with it."""
        self._target, self._because, self._last_change = number, because, perception.ego.time

    def _wanted(self, perception: Perception) -> tuple[int | None, str]:
        for_route = lane_for_route(perception, self._route_rule)
        if for_route is not None:
            return for_route, LANE_END
        if perception.ego.time < self._last_change + self._incentive_rule.pause:
            return None, ""
        ahead = perception.gaps.ahead
        return better_lane(perception, self._style, self._incentive_rule), ahead.name if ahead else ""


def lane_for_route(perception: Perception, rule: RouteRule | None = None) -> int | None:
    """Return the adjacent lane that the route asks for now, ``None`` if the present one still serves.

    Notes
    -----
    Of the adjacent lanes the one that follows the route for longer is taken. Where none does, several
    changes are needed, and they lead to the side on which the road goes on beyond the lanes in view, but
    never into a lane that serves the route worse than the present one: from there the way would lead back.
    """
    rule = rule or RouteRule()
    road, ego = perception.road, perception.ego
    here = road.lane(road.reference)
    if here is None or here.follows_route_for >= road.route_end:
        return None
    beside = [lane for lane in road.lanes if abs(lane.number - here.number) == 1]
    better = [lane for lane in beside if lane.follows_route_for > here.follows_route_for + SAME_END]
    as_good = [lane for lane in beside if lane.follows_route_for >= here.follows_route_for - SAME_END]
    candidates = better or [lane for lane in as_good if _road_goes_on(lane, here, road)] or as_good
    if not candidates:
        return None
    changes = 1 if better and np.isinf(max(lane.follows_route_for for lane in better)) else 2
    needed = changes * (1.0 + rule.search) * max(rule.distance, rule.time * ego.speed)
    if here.follows_route_for - ego.body.front > needed:
        return None
    # max() keeps the first of equals: the right one, where traffic is slower.
    return max(candidates, key=lambda lane: lane.follows_route_for).number


def blocker(
    perception: Perception, number: int, rule: GapRule | None = None, *, begun: bool = False
) -> str | None:
    """Return who makes a change to an adjacent lane unsafe, ``None`` if nobody does.

    Parameters
    ----------
    perception : what the ego knows
    number : ``Lane.number`` of a lane beside the reference lane
    rule : how large the gaps have to be
    begun : judge a change that is under way, by the smaller gaps that make it be given up

    Notes
    -----
    Judged are the neighbours as they are now, and all vehicles at constant velocity over the duration of
    the manoeuvre, also those that come over from a third lane or into the gap from the ego's own.
    """
    rule = rule or GapRule()
    road = perception.road
    lane = road.lane(number)
    if lane is None:
        return "no such lane"
    if lane.number == road.reference:
        return None
    ahead, behind = _adjacent(perception.gaps, left=lane.number > road.reference)
    speed = max(perception.ego.speed, 0.0)
    if ahead is not None and ahead.gap < _required(speed, ahead.speed, rule, begun):
        return ahead.name
    if behind is not None and behind.gap < _required(behind.speed, speed, rule, begun):
        return behind.name
    return _meets(perception, lane, rule, begun)


def _adjacent(gaps: NeighbourGaps, *, left: bool) -> tuple[Neighbour | None, Neighbour | None]:
    if left:
        return gaps.left_ahead, gaps.left_behind
    return gaps.right_ahead, gaps.right_behind


def _required(follower: float, leader: float, rule: GapRule, begun: bool) -> float:
    """Return G_min for the follower's speed, plus what braking down to the leader's needs [m]."""
    follower, leader = max(follower, 0.0), max(leader, 0.0)
    smallest = rule.minimum + rule.headway * follower
    squared = max(follower - leader, 0.0) ** 2
    if begun:
        return rule.abort_share * smallest + squared / (2.0 * rule.abort_deceleration)
    return smallest + squared / (2.0 * rule.deceleration)


def _meets(perception: Perception, lane: Lane, rule: GapRule, begun: bool) -> str | None:
    """Return the first vehicle that would come too near in the target lane at constant velocities."""
    others, ego = perception.vehicles, perception.ego
    if len(others) == 0:
        return None
    speed = max(ego.speed, 0.0)
    times = np.arange(0.0, (rule.abort_duration if begun else rule.duration) + 0.25, 0.5)[:, None]
    share = rule.abort_share if begun else rule.later_share
    across = others.across + others.across_speed * times
    front = others.along + others.along_speed * times
    ego_front = ego.body.front + speed * times
    # Nobody may be in the strip from where the ego is to where it goes, whichever side they come from.
    reach = 0.5 * (others.width + ego.body.width) + rule.side
    inside = np.abs(across - lane.offset) < reach
    gap_ahead = front - others.length - ego_front
    gap_behind = ego_front - ego.body.length - front
    ahead_needed = share * (rule.minimum + rule.headway * speed)
    behind_needed = share * (rule.minimum + rule.headway * np.maximum(others.along_speed, 0.0))
    near = inside & (gap_ahead < ahead_needed) & (gap_behind < behind_needed)
    hits = np.flatnonzero(near.any(axis=0))
    return others.names[int(hits[0])] if len(hits) else None


def _road_goes_on(lane: Lane, here: Lane, road: RoadAhead) -> bool:
    """Say whether there are lanes beyond an adjacent one."""
    edge = road.left_edge if lane.number > here.number else road.right_edge
    return abs(edge - lane.offset) > 0.9 * lane.width
