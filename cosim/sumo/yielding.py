"""Makes SUMO's own drivers brake for scripted pedestrians, of whom SUMO does not know.

SUMO's drivers can see a person that ``moveToXY`` puts on a lane, but not reliably and not safely: see
docs/pedestrians.md. This module therefore limits the speed of each vehicle that would meet a pedestrian, as
if its driver expected the pedestrian to keep walking for a short time. Following vehicles react as usual.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.pedestrians.behaviour import RADIUS, STANDING, RoadUser
from cosim.sumo.traffic_near import Body, TrafficNear

LOOK_AHEAD = 2.5
"""A driver expects a pedestrian to keep their velocity for this time [s]."""
LOOK_AHEAD_PRIORITY = 4.0
"""A driver expects a pedestrian with the right of way on a crossing to do so for this time [s]."""
STEPPING_OUT = 1.3
"""Speed at which a waiting pedestrian with the right of way is expected to step out [m/s]."""
STOP_LINE = 1.5
"""Distance from the crossing at which a yielding vehicle stops [m]."""
SIDE_MARGIN = 0.3
"""A pedestrian is in a vehicle's path if the gap beside the vehicle would be smaller than this [m]."""
NEXT_LANE = 3.5
"""No vehicle changes lanes if a pedestrian is this near to the side of its path [m]."""
KEEPS_ITS_LANE = 512
"""Lane-change mode: SUMO makes no lane changes of its own."""
INTERVAL = 0.25
"""Interval between the times at which a pedestrian's expected positions are checked [s]."""
OBEYS_BRAKES_BEYOND_COMFORT = ~4
"""Mask that clears the bit of the speed mode by which SUMO brakes no harder than comfortably."""


@dataclass(frozen=True, slots=True)
class Seen:
    """A scripted pedestrian as seen by a driver."""

    x: float
    y: float
    x_speed: float
    y_speed: float
    has_priority: bool = False
    """Whether they are on, or about to step on, a crossing where vehicles have to wait."""
    half_crossing: float = 0.0
    """Half the crossing's width: a vehicle stops before it [m]."""


class Yielding:
    """Bounds the speeds of SUMO's vehicles, and keeps them in their lanes, near scripted pedestrians.

    Parameters
    ----------
    sumo : module or connection
    traffic : the vehicles near pedestrians
    step : length of a step [s]
    """

    def __init__(self, sumo: Any, traffic: TrafficNear, step: float) -> None:
        self._sumo = sumo
        self._traffic = traffic
        self._step = step
        self._held: dict[str, int] = {}
        """Original speed mode of each vehicle whose speed is bounded."""
        self._kept: dict[str, int] = {}
        """Original lane-change mode of each vehicle that must not change lanes."""

    def hold(
        self, seen: Mapping[str, Seen], near: Mapping[str, Sequence[RoadUser]], driven: Collection[str]
    ) -> None:
        """Bound the speeds of the coming step; call it once before every step.

        Parameters
        ----------
        seen : pedestrians on the road, moving or about to be, by name
        near : the vehicles near each of them
        driven : vehicles that controllers drive; the controllers have to brake
        """
        caps: dict[str, tuple[float, float]] = {}
        keeps: set[str] = set()
        for name, pedestrian in seen.items():
            for vehicle in near[name]:
                if vehicle.name in driven:
                    continue
                look = self._look(vehicle, pedestrian, self._traffic.body(vehicle.name))
                if look is None:
                    continue
                keeps.add(vehicle.name)
                before = caps.get(vehicle.name)
                if look < math.inf and (before is None or look < before[0]):
                    caps[vehicle.name] = (look, vehicle.speed)
        self._release(self._held.keys() - caps.keys(), self._kept.keys() - keeps)
        vehicle_domain = self._sumo.vehicle
        for name in sorted(keeps - self._kept.keys()):
            self._kept[name] = vehicle_domain.getLaneChangeMode(name)
            vehicle_domain.setLaneChangeMode(name, KEEPS_ITS_LANE)
        for name, (cap, speed) in caps.items():
            if name not in self._held:
                mode: int = vehicle_domain.getSpeedMode(name)
                self._held[name] = mode
                vehicle_domain.setSpeedMode(name, mode & OBEYS_BRAKES_BEYOND_COMFORT)
            hardest = speed - self._traffic.body(name).hardest * self._step
            vehicle_domain.setSpeed(name, max(cap, hardest, 0.0))

    def _release(self, held: Collection[str], kept: Collection[str]) -> None:
        """Hand vehicles that are still there back to their drivers."""
        if not held and not kept:
            return
        there = set(self._sumo.vehicle.getIDList())
        for name in sorted(held):
            mode = self._held.pop(name)
            if name in there:
                self._sumo.vehicle.setSpeed(name, -1.0)
                self._sumo.vehicle.setSpeedMode(name, mode)
        for name in sorted(kept):
            mode = self._kept.pop(name)
            if name in there:
                self._sumo.vehicle.setLaneChangeMode(name, mode)

    def forget(self, name: str) -> None:
        """Give a vehicle back to its driver and leave it alone from now on: another driver takes it over."""
        self._release([name] if name in self._held else [], [name] if name in self._kept else [])

    def _look(self, vehicle: RoadUser, pedestrian: Seen, body: Body) -> float | None:
        """Return the highest speed of the coming step [m/s]: inf for any; ``None`` for no concern at all."""
        before = max(RADIUS + body.min_gap, pedestrian.half_crossing + STOP_LINE)
        # Pedestrians farther away than a comfortable stop takes do not matter yet; no way is shorter than a
        # straight line.
        far = stopping_distance(vehicle.speed + body.comfortable * self._step, body.comfortable, self._step)
        walked = LOOK_AHEAD_PRIORITY * math.hypot(pedestrian.x_speed, pedestrian.y_speed)
        if math.dist((vehicle.x, vehicle.y), (pedestrian.x, pedestrian.y)) > far + before + walked:
            return None
        sight = _sight(vehicle, pedestrian)
        if sight is None or math.isinf(sight):
            return sight
        cap = stopping_speed(sight - before, body.comfortable, self._step)
        return math.inf if cap > vehicle.speed + body.comfortable * self._step else cap


def stopping_speed(gap: float, deceleration: float, step: float) -> float:
    """Return the speed of a step after which a constant deceleration stops within a gap [m/s].

    v · h + v² / (2 b) = g, so v = −b h + √((b h)² + 2 b g).

    Parameters
    ----------
    gap : g [m]
    deceleration : b [m/s^2]
    step : h [s]

    >>> stopping_speed(8.0, 4.0, 0.0)
    8.0
    """
    if gap <= 0.0:
        return 0.0
    lost = deceleration * step
    return -lost + math.sqrt(lost * lost + 2.0 * deceleration * gap)


def stopping_distance(speed: float, deceleration: float, step: float) -> float:
    """Return the distance of a step at a speed and a stop from it [m]; the inverse of `stopping_speed`.

    >>> stopping_distance(stopping_speed(17.0, 4.0, 0.1), 4.0, 0.1)
    17.0
    """
    return speed * step + speed**2 / (2.0 * deceleration)


def _sight(vehicle: RoadUser, pedestrian: Seen) -> float | None:
    """Return the distance from the front bumper to a pedestrian who is or soon will be in the path [m].

    It is inf for a pedestrian beside the path, and ``None`` if they are far from it or behind the vehicle.
    """
    half = 0.5 * vehicle.width + RADIUS + SIDE_MARGIN
    until = LOOK_AHEAD_PRIORITY if pedestrian.has_priority else LOOK_AHEAD
    times = np.linspace(0.0, until, round(until / INTERVAL) + 1)
    x, y = pedestrian.x + pedestrian.x_speed * times, pedestrian.y + pedestrian.y_speed * times
    along, across = vehicle.sees(np.column_stack([x, y]))
    if along[0] < -vehicle.length or np.abs(across).min() > half + NEXT_LANE:
        return None
    # By then the vehicle is past, if it does not brake.
    past = (along + vehicle.length + RADIUS) / max(vehicle.speed, STANDING) < times
    in_the_way = (np.abs(across) <= half) & (along >= 0.0) & ~past
    # A pedestrian beside the vehicle now cannot be hit by its front.
    if along[0] < 0.0 or not in_the_way.any():
        return math.inf
    return float(along[in_the_way].min())
