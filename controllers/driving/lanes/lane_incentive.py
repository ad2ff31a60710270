"""Whether the ego can drive better in another lane: around roadworks, past a slow vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.following import desired_gap, free_acceleration, limit_now
from controllers.driving.standing import VEHICLE_STANDING
from controllers.interface import Lane, Neighbour, Perception


@dataclass(frozen=True, slots=True)
class IncentiveRule:
    """Conditions under which a better lane is worth a change."""

    advantage: float = 0.5
    """The ego must be able to accelerate by this much more in the other lane [m/s^2]."""
    pause: float = 5.0
    """Time between two changes that the route does not require [s]."""
    stay_distance: float = 120.0
    """The other lane must lead along the route for at least this distance [m] …"""
    stay_time: float = 12.0
    """… and for at least this time at the present speed [s]."""
    before_crossing: float = 35.0
    """No change begins within this distance before a crossing [m] …"""
    after_crossing: float = 12.0
    """… or within this distance after it [m] …"""
    slow: float = 1.0
    """… unless the ego is slower than this [m/s]."""


def better_lane(perception: Perception, style: DrivingStyle, rule: IncentiveRule) -> int | None:
    """Return the adjacent lane in which the ego could accelerate more, ``None`` if no lane is worth a change.

    Notes
    -----
    This is the incentive criterion of [Kesting2007]_ without politeness. The accelerations are those of the
    car-following model behind the leader of each lane; none is below the comfortable deceleration.
    """
    road, ego, gaps = perception.road, perception.ego, perception.gaps
    near = any(
        one.entry - rule.before_crossing < ego.body.front and one.exit + rule.after_crossing > 0.0
        for one in road.crossings
    )
    if gaps.ahead is None or (near and ego.speed >= rule.slow):
        return None
    limit = limit_now(road, ego.body.front)
    here = _acceleration(ego.speed, limit, gaps.ahead, style)
    best, found = here + rule.advantage, None
    for lane in road.lanes:
        side = lane.number - road.reference
        if abs(side) != 1 or not _leads_on(lane, perception, rule):
            continue
        there = _acceleration(ego.speed, limit, gaps.left_ahead if side > 0 else gaps.right_ahead, style)
        if there > best:
            best, found = there, lane.number
    return found


def _leads_on(lane: Lane, perception: Perception, rule: IncentiveRule) -> bool:
    needed = perception.ego.body.front + max(rule.stay_distance, rule.stay_time * perception.ego.speed)
    return lane.follows_route_for >= min(needed, perception.road.route_end)


def _acceleration(speed: float, limit: float, leader: Neighbour | None, style: DrivingStyle) -> float:
    free = free_acceleration(speed, limit, style)
    if leader is None or math.isinf(leader.gap):
        return free
    # An ego that waits to get around a standing vehicle keeps room to steer, and must still want to go then.
    standstill = style.room_to_change if leader.speed < VEHICLE_STANDING else style.standstill_gap
    wanted = desired_gap(speed, max(leader.speed, 0.0), standstill, style.headway, style)
    following = free - style.acceleration * (wanted / max(leader.gap, 0.1)) ** 2
    return max(following, -style.deceleration)
