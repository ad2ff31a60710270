"""Which lane to be in so that the route can be followed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.interface import Lane, Perception, RoadAhead

SAME_END = 10.0
"""Lanes whose ends differ by less than this end at the same place, as their lengths differ in bends [m]."""
STANDS = 1.0
"""An ego below this speed may still go back on a lane change [m/s]."""


@dataclass(frozen=True, slots=True)
class RouteRule:
    """Conditions under which the ego has to leave its lane for the route."""

    distance: float = 60.0
    """Distance that a lane change takes at least [m]."""
    time: float = 5.0
    """Time that a lane change takes at least [s]."""
    search: float = 1.0
    """Additional room to find a gap, as a multiple of what the lane change takes [-]."""


def lane_for_route(perception: Perception, rule: RouteRule | None = None) -> int | None:
    """Return the adjacent lane that the route requires now, ``None`` if the present one still serves.

    Notes
    -----
    The adjacent lane that follows the route for longer is taken. If none does, several changes are needed.
    They lead to the side on which the road goes on beyond the lanes in view, but never into a lane that
    serves the route worse than the present one, because the way would lead back from there.
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
    # max() keeps the first of equals: the lane on the right, where traffic is slower.
    return max(candidates, key=lambda lane: lane.follows_route_for).number


def leads_off_now(perception: Perception, target: int) -> bool:
    """Return whether a lane change under way has become wrong for an ego that almost stands.

    The ego may have been given another route since the change began. Then its own lane follows the route, and
    the lane that it is changing to does not.
    """
    road = perception.road
    here, there = road.lane(road.reference), road.lane(target)
    if here is None or there is None or perception.ego.speed >= STANDS:
        return False
    return here.follows_route_for > there.follows_route_for + SAME_END


def _road_goes_on(lane: Lane, here: Lane, road: RoadAhead) -> bool:
    """Return whether there are more lanes beyond an adjacent one."""
    edge = road.left_edge if lane.number > here.number else road.right_edge
    return abs(edge - lane.offset) > 0.9 * lane.width
