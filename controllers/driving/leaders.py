"""What the ego has to stay behind: vehicles in the way, places to stop at, the end of the lane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from controllers.driving.driving_style import DrivingStyle
from controllers.driving.right_of_way import StopPlace
from controllers.driving.standing import VEHICLE_STANDING
from controllers.interface import EgoState, Neighbour, Perception

LANE_END = "lane end"


@dataclass(slots=True)
class Leader:
    """Something to stay behind; the prediction changes ``gap`` and ``speed``."""

    name: str
    gap: float
    speed: float
    acceleration: float
    standstill_gap: float
    headway: float


def neighbours_ahead(
    perception: Perception, target_lane: int, style: DrivingStyle, leaving: bool
) -> tuple[list[Leader], list[Neighbour]]:
    """Return the vehicles to stay behind, and those to drive past slowly."""
    gaps, road = perception.gaps, perception.road
    seen = [gaps.ahead] if gaps.ahead is not None else []
    beside = None
    if target_lane > road.reference:
        beside = gaps.left_ahead
    elif target_lane < road.reference:
        beside = gaps.right_ahead
    # Braking cannot bring the ego behind a vehicle that overlaps it along the road; the choice of lanes takes
    # care of such vehicles.
    if beside is not None and beside.gap > 0.0:
        seen.append(beside)
    ahead = [one for one in seen if _in_the_way(perception, one, target_lane, style)]
    passed = [one for one in seen if one not in ahead]
    own_gap = style.standstill_gap
    if gaps.ahead is not None and gaps.ahead.speed < VEHICLE_STANDING:
        if target_lane != road.reference:
            own_gap = style.room_to_swing
        elif leaving:
            own_gap = style.room_to_change
    leaders = [
        Leader(
            one.name,
            one.gap,
            max(one.speed, 0.0),
            one.acceleration,
            own_gap if one is gaps.ahead else style.standstill_gap,
            style.headway,
        )
        for one in ahead
    ]
    return leaders, passed


def _in_the_way(perception: Perception, neighbour: Neighbour, target_lane: int, style: DrivingStyle) -> bool:
    """Return whether a neighbour is in the way between the ego's place in the lane and its goal.

    The ego can drive past a standing vehicle that only juts out into the lane, but never past a moving one.
    """
    others, ego = perception.vehicles, perception.ego
    if neighbour.speed >= VEHICLE_STANDING or neighbour.name not in others.names:
        return True
    index = others.names.index(neighbour.name)
    turned = float(others.heading_error[index])
    half = 0.5 * abs(float(others.width[index]) * math.cos(turned)) + 0.5 * abs(
        float(others.length[index]) * math.sin(turned)
    )
    reach = half + 0.5 * ego.body.width + style.side_clearance
    place = float(others.across[index])
    front = ego.across + ego.body.front * math.sin(ego.heading_error)
    if target_lane != perception.road.reference and neighbour is perception.gaps.ahead:
        side = math.copysign(1.0, target_lane - perception.road.reference)
        return side * (_swung_out(ego, side, max(neighbour.gap, 0.0), style) - place) < reach
    lane = perception.road.lane(target_lane)
    goal = lane.offset if lane is not None else 0.0
    return min(ego.across, front, goal) - reach < place < max(ego.across, front, goal) + reach


def _swung_out(ego: EgoState, side: float, distance: float, style: DrivingStyle) -> float:
    """Return the across coordinate of the front after swinging out to one side over a distance [m].

    The wheels turn first; until they have, the ego goes straight on.
    """
    fastest = max(ego.speed + style.acceleration * ego.plan_interval, 1.0)
    curvature = min(style.swing_curvature, style.swing_acceleration / fastest**2)
    missing = max(math.atan(ego.body.wheelbase * curvature) - side * ego.steering, 0.0)
    turning = ego.drive.steering_lag + 0.5 * missing / ego.drive.max_steering_rate
    straight = min(max(ego.speed, 0.0) * turning, distance)
    begin, rest = ego.heading_error, distance - straight
    end = side * min(side * begin + curvature * rest, max(style.swing_angle, side * begin))
    out = straight * math.sin(begin) + rest * math.sin(0.5 * (begin + end))
    return ego.across + ego.body.front * math.sin(end) + out


def standing_places(
    perception: Perception, target_lane: int, stops: Sequence[StopPlace], style: DrivingStyle
) -> list[Leader]:
    """Return the places to stop at, including the end of the ego's lane, as standing leaders."""
    road, front = perception.road, perception.ego.body.front
    found = [
        Leader(stop.name, stop.along - front, 0.0, 0.0, style.stop_gap, style.stop_headway) for stop in stops
    ]
    lane = road.lane(road.reference)
    if lane is not None and lane.follows_route_for < min(road.route_end, math.inf):
        room = style.room_to_change if target_lane == road.reference else 0.0
        gap = lane.follows_route_for - front - room
        found.append(Leader(LANE_END, gap, 0.0, 0.0, style.stop_gap, style.stop_headway))
    return found
