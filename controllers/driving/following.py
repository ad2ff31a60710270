"""How fast to drive with regard to the road, its rules and other vehicles only.

Car-following uses the Intelligent Driver Model, in which every place to stop at is a standing leader. A speed
profile slows down for lower limits and for bends at a comfortable deceleration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.leaders import Leader, neighbours_ahead, standing_places
from controllers.driving.right_of_way import RightOfWay
from controllers.interface import EgoState, Perception, RoadAhead

SPEED_LIMIT = "speed limit"
BEND = "bend"


@dataclass(frozen=True, slots=True)
class Longitudinal:
    """Desired accelerations, and the reason why they are not those of a free road."""

    acceleration: FloatArray
    """One for each instant asked for [m/s^2]."""
    because: str
    """Vehicle, signal, ``lane end``, ``bend`` or ``speed limit``; empty if the road is free."""


class Following:
    """The longitudinal half of a driver; one per ego, as it remembers which junction foes are standing."""

    def __init__(self, style: DrivingStyle | None = None) -> None:
        self.style = style or DrivingStyle()
        self._right_of_way = RightOfWay(self.style.acceleration)

    def follow(
        self,
        perception: Perception,
        target_lane: int,
        times: FloatArray,
        *,
        leaving: bool = False,
        free_speed: float | None = None,
    ) -> Longitudinal:
        """Return desired accelerations at the given times from now.

        Parameters
        ----------
        perception : what the ego knows
        target_lane : ``Lane.number`` to end in; the ego follows its leader as well as that of its own lane
        times : instants from now, ascending from 0 [s]
        leaving : whether the ego waits for a chance to leave its lane; then it keeps more room to a standing
            leader
        free_speed : desired speed where nothing is ahead; ``None``: the speed limit here [m/s]

        Notes
        -----
        Over the instants, the leaders keep their accelerations, and the ego's follows the desired one with
        the drive lag.
        """
        ego, style = perception.ego, self.style
        stops = self._right_of_way.stops(perception)
        ahead, passed = neighbours_ahead(perception, target_lane, style, leaving)
        leaders = [
            *ahead,
            *standing_places(perception, target_lane, stops, style),
        ]
        places, speeds, names = speed_targets(perception.road, ego.body.front, style)
        slowly = [(one.name, max(one.gap, 0.0), style.passing_speed) for one in passed]
        let_go_first = self._right_of_way.passed(perception)
        slowly += [(foe.name, foe.along - ego.body.front, foe.speed) for foe in let_go_first]
        if slowly:
            more_names, more_places, more_speeds = zip(*slowly, strict=True)
            names = (*names, *more_names)
            places, speeds = np.append(places, more_places), np.append(speeds, more_speeds)
        free = limit_now(perception.road, ego.body.front) if free_speed is None else free_speed
        result = np.zeros(len(times))
        speed, actual, gone = max(ego.speed, 0.0), ego.acceleration, 0.0
        because = ""
        for i in range(len(times)):
            asked, reason = _desired(speed, free, leaders, places - gone, speeds, names, style)
            result[i] = min(max(asked, -ego.drive.max_deceleration), ego.drive.max_acceleration)
            because = reason if i == 0 else because
            step = float(times[i + 1] - times[i]) if i + 1 < len(times) else 0.0
            actual += (result[i] - actual) * _share(ego, step)
            moved = max(speed * step + 0.5 * actual * step * step, 0.0)
            speed = max(speed + actual * step, 0.0)
            gone += moved
            for leader in leaders:
                leader.gap += leader.speed * step - moved
                leader.speed = max(leader.speed + leader.acceleration * step, 0.0)
        return Longitudinal(result, because)


def free_acceleration(speed: float, desired: float, style: DrivingStyle) -> float:
    """Return the acceleration on a free road [m/s^2].

    a · (1 − (v / v0)⁴) up to the desired speed v0, −b · (1 − (v0 / v)^(4 a / b)) above it.

    Notes
    -----
    [Treiber2000]_; above the desired speed as in the improved model of [Treiber2013]_, because the
    original brakes without bound where a limit drops.

    >>> free_acceleration(10.0, 10.0, DrivingStyle())
    0.0
    """
    desired = max(desired, 0.1)
    if speed <= desired:
        return style.acceleration * (1.0 - (speed / desired) ** 4)
    slower: float = (desired / speed) ** (4.0 * style.acceleration / style.deceleration)
    return -style.deceleration * (1.0 - slower)


def desired_gap(
    speed: float, leader_speed: float, standstill: float, headway: float, style: DrivingStyle
) -> float:
    """Return the gap s* = s0 + max(0, v T + v Δv / (2 √(a b))) that the model keeps [m].

    Notes
    -----
    Eq. (3) of [Treiber2000]_, without its root term.

    >>> desired_gap(10.0, 10.0, 2.5, 1.0, DrivingStyle())
    12.5
    """
    closing = speed * (speed - leader_speed) / (2.0 * math.sqrt(style.acceleration * style.deceleration))
    return standstill + max(0.0, speed * headway + closing)


def speed_targets(
    road: RoadAhead, front: float, style: DrivingStyle
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return places ahead [m], the speeds that must not be exceeded there [m/s], and the reasons.

    Speed limits hold for the front bumper; a bend allows √(a_lat / |κ|) at the rear axle.

    Parameters
    ----------
    road : as seen
    front : distance from the rear axle to the front bumper [m]
    style : gives the lateral acceleration
    """
    ahead = road.limit_along > front
    limit_places, limits = np.maximum(road.limit_along - front, 0.0)[ahead], road.limit[ahead]
    bent = (np.abs(road.curvature) > 1e-4).nonzero()[0]
    if not len(bent):
        return limit_places, limits, (SPEED_LIMIT,) * len(limits)
    bend_speeds = np.sqrt(style.lateral_acceleration / np.abs(road.curvature[bent]))
    return (
        np.concatenate([limit_places, bent * road.curvature_step]),
        np.concatenate([limits, np.maximum(bend_speeds, style.slowest_bend)]),
        (SPEED_LIMIT,) * len(limits) + (BEND,) * len(bent),
    )


def limit_now(road: RoadAhead, front: float) -> float:
    """Return the speed limit at the front bumper [m/s]."""
    passed = (road.limit_along <= front).nonzero()[0]
    if len(passed):
        return float(road.limit[passed[-1]])
    return float(road.limit[0]) if len(road.limit) else math.inf


def _desired(
    speed: float,
    limit: float,
    leaders: Sequence[Leader],
    places: FloatArray,
    speeds: FloatArray,
    names: tuple[str, ...],
    style: DrivingStyle,
) -> tuple[float, str]:
    """Return the smallest of all accelerations, and its reason unless it is that of the free road."""
    free = free_acceleration(speed, limit, style)
    best, because = free, ""
    for leader in leaders:
        wanted = desired_gap(speed, leader.speed, leader.standstill_gap, leader.headway, style)
        asked = free - style.acceleration * (wanted / max(leader.gap, 0.1)) ** 2
        if asked < best:
            best, because = asked, leader.name
    ahead = (places > -0.5).nonzero()[0]
    if len(ahead):
        allowed = np.sqrt(speeds[ahead] ** 2 + 2.0 * style.deceleration * np.maximum(places[ahead], 0.0))
        tightest = int(np.argmin(allowed))
        asked = _towards(speed, float(allowed[tightest]), float(speeds[ahead[tightest]]), style)
        if asked < best:
            best, because = asked, names[ahead[tightest]]
    return best, because if best < free - 0.1 else ""


def _towards(speed: float, allowed: float, end: float, style: DrivingStyle) -> float:
    """Return the acceleration [m/s^2] that follows the braking curve √(v_end² + 2 b x).

    ``allowed`` is the value of the curve here. At this speed the acceleration is −b, at a lower speed it is
    greater. It is never less than what leads to the end speed within half a second.
    """
    along_curve = (allowed - speed) / 1.0 - style.deceleration * min(speed / max(allowed, 0.1), 1.0)
    return max(along_curve, (end - speed) / 0.5)


def _share(ego: EgoState, step: float) -> float:
    """Return the share of a change of command that the drive lag lets through within a time step."""
    lag = ego.drive.drive_lag
    return -math.expm1(-step / lag) if lag > 0.0 else 1.0
