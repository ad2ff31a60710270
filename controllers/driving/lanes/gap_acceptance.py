"""Whether another lane is free: whether the gaps to the vehicles ahead and behind in it are large enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.driving.standing import VEHICLE_STANDING, standing
from controllers.interface import Lane, Neighbour, NeighbourGaps, Perception


@dataclass(frozen=True, slots=True)
class GapRule:
    """Conditions under which the gaps of another lane are large enough.

    At the beginning each gap must be at least G_min = minimum + headway · v plus the distance needed to brake
    off the closing speed; later in the manoeuvre it must stay above a share of G_min. Before a vehicle that
    stands behind, ``side`` is enough.
    """

    minimum: float = 2.5
    """Gap at standstill [m]."""
    headway: float = 1.0
    """Time gap of the follower [s]."""
    deceleration: float = 2.0
    """Deceleration with which a closing speed is reduced [m/s^2]."""
    duration: float = 4.0
    """Time over which other vehicles are predicted, at constant velocity [s]."""
    later_share: float = 0.5
    """Share of G_min that must be left at any time of the manoeuvre."""
    abort_share: float = 0.3
    """A change that has begun is given up if a gap is below this share of G_min …"""
    abort_deceleration: float = 4.0
    """… plus the distance that the follower needs to slow down with this deceleration [m/s^2]."""
    abort_duration: float = 1.0
    """Time over which others are predicted once a change has begun: they notice it within this time [s]."""
    pause_below: float = 3.0
    """Below this speed, a change is paused and not given up: there is no room to steer back [m/s]."""
    side: float = 0.3
    """Distance kept beside other vehicles, and before one that stands behind. That one may be letting the ego
    in: if the ego waited for a larger gap, neither would move [m]."""


def blocker(
    perception: Perception, number: int, rule: GapRule | None = None, *, begun: bool = False
) -> str | None:
    """Return the vehicle that makes a change to an adjacent lane unsafe, ``None`` if there is none.

    Parameters
    ----------
    perception : what the ego knows
    number : ``Lane.number`` of a lane beside the reference lane
    rule : how large the gaps have to be
    begun : whether the change is under way; it is then given up only at smaller gaps

    Notes
    -----
    The rule is applied to the neighbours as they are now, and to all vehicles at constant velocity over the
    duration of the manoeuvre. These include vehicles that come from a third lane, or from the ego's own lane
    into the gap.
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
    if behind is not None:
        stands = behind.speed < VEHICLE_STANDING
        if behind.gap < (rule.side if stands else _required(behind.speed, speed, rule, begun)):
            return behind.name
    return _meets(perception, lane, rule, begun)


def _adjacent(gaps: NeighbourGaps, *, left: bool) -> tuple[Neighbour | None, Neighbour | None]:
    if left:
        return gaps.left_ahead, gaps.left_behind
    return gaps.right_ahead, gaps.right_behind


def _required(follower: float, leader: float, rule: GapRule, begun: bool) -> float:
    """Return G_min for the follower's speed, plus the distance to brake down to the leader's speed [m]."""
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
    # No vehicle may be in the target lane, whichever side it comes from.
    reach = 0.5 * (others.width + ego.body.width) + rule.side
    inside = np.abs(across - lane.offset) < reach
    gap_ahead = front - others.length - ego_front
    gap_behind = ego_front - ego.body.length - front
    ahead_needed = share * (rule.minimum + rule.headway * speed)
    behind_needed = np.where(
        standing(others),
        rule.side,
        share * (rule.minimum + rule.headway * np.maximum(others.along_speed, 0.0)),
    )
    near = inside & (gap_ahead < ahead_needed) & (gap_behind < behind_needed)
    hits = np.flatnonzero(near.any(axis=0))
    return others.names[int(hits[0])] if len(hits) else None
