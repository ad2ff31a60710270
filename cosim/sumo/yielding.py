"""SUMO's own drivers brake for scripted pedestrians, whom SUMO does not know.

SUMO's drivers can see a person that ``moveToXY`` puts on a lane, but not for long and not safely: see
docs/pedestrians.md. So the speed of each vehicle that would meet one is bounded from here, as a driver would
who expects him to walk on as he does for a short time. Following vehicles then react to it as to any other.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.pedestrians.scene import RADIUS, RoadUser
from cosim.sumo.traffic_near import Body, TrafficNear

LOOK_AHEAD = 1.5
"""A driver expects somebody to walk on as he does for this time [s]."""
LOOK_AHEAD_PRIORITY = 4.0
"""The same for somebody who has the right of way on a crossing [s]."""
STEPPING_OUT = 1.3
"""Speed at which somebody with the right of way who waits is expected to step out [m/s]."""
STOP_LINE = 1.5
"""Distance from the crossing at which a vehicle stops that lets somebody go first [m]."""
SIDE_MARGIN = 0.3
"""Between the vehicle's side and the pedestrian's [m]."""
INTERVAL = 0.25
"""[s]"""
OBEYS_BRAKES_BEYOND_COMFORT = ~4
"""Bit of the speed mode that keeps a commanded speed within comfortable braking."""


@dataclass(frozen=True, slots=True)
class Seen:
    """A scripted pedestrian as a driver sees him."""

    x: float
    y: float
    x_speed: float
    y_speed: float
    has_priority: bool = False
    """On a crossing, or about to step on it, where vehicles have to wait."""
    half_crossing: float = 0.0
    """Half the crossing's width: a vehicle stops before it [m]."""


class Yielding:
    """Bounds the speeds of SUMO's vehicles.

    Parameters
    ----------
    sumo : module or connection
    traffic : the vehicles near pedestrians
    step : [s]
    """

    def __init__(self, sumo: Any, traffic: TrafficNear, step: float) -> None:
        self._sumo = sumo
        self._traffic = traffic
        self._step = step
        self._held: dict[str, int] = {}
        """Speed mode that each held vehicle had."""

    def hold(
        self, seen: Mapping[str, Seen], near: Mapping[str, Sequence[RoadUser]], driven: Collection[str]
    ) -> None:
        """Bound the speeds of the coming step; call it once before every step.

        Parameters
        ----------
        seen : pedestrians by name
        near : the vehicles near each of them
        driven : vehicles that controllers drive: they have to brake themselves
        """
        caps: dict[str, tuple[float, float]] = {}
        for name, pedestrian in seen.items():
            for vehicle in near[name]:
                if vehicle.name in driven:
                    continue
                cap = self._cap(vehicle, pedestrian, self._traffic.body(vehicle.name))
                before = caps.get(vehicle.name)
                if cap is not None and (before is None or cap < before[0]):
                    caps[vehicle.name] = (cap, vehicle.speed)
        self._release(self._held.keys() - caps.keys())
        for name, (cap, speed) in caps.items():
            if name not in self._held:
                mode: int = self._sumo.vehicle.getSpeedMode(name)
                self._held[name] = mode
                self._sumo.vehicle.setSpeedMode(name, mode & OBEYS_BRAKES_BEYOND_COMFORT)
            hardest = speed - self._traffic.body(name).hardest * self._step
            self._sumo.vehicle.setSpeed(name, max(cap, hardest, 0.0))

    def _release(self, names: Collection[str]) -> None:
        """Hand vehicles back to their drivers, those that are still there and not driven by a controller."""
        if not names:
            return
        there = set(self._sumo.vehicle.getIDList())
        for name in sorted(names):
            mode = self._held.pop(name)
            if name in there:
                self._sumo.vehicle.setSpeed(name, -1.0)
                self._sumo.vehicle.setSpeedMode(name, mode)

    def forget(self, name: str) -> None:
        """Leave a vehicle alone from now on: somebody else drives it."""
        self._held.pop(name, None)

    def _cap(self, vehicle: RoadUser, pedestrian: Seen, body: Body) -> float | None:
        """Return the highest speed of the coming step; ``None`` if he is not in its way or far enough."""
        ahead = _ahead(vehicle, pedestrian)
        if ahead is None:
            return None
        gap = ahead - max(RADIUS + body.min_gap, pedestrian.half_crossing + STOP_LINE)
        cap = stopping_speed(gap, body.comfortable, self._step)
        if cap > vehicle.speed + body.comfortable * self._step:
            return None
        return cap


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


def _ahead(vehicle: RoadUser, pedestrian: Seen) -> float | None:
    """Return the distance from the front bumper to where he is, or soon will be, in the vehicle's way [m]."""
    half = 0.5 * vehicle.width + RADIUS + SIDE_MARGIN
    until = LOOK_AHEAD_PRIORITY if pedestrian.has_priority else LOOK_AHEAD
    times = np.linspace(0.0, until, round(until / INTERVAL) + 1)
    x, y = pedestrian.x + pedestrian.x_speed * times, pedestrian.y + pedestrian.y_speed * times
    along, across = vehicle.sees(np.column_stack([x, y]))
    in_the_way = (np.abs(across) <= half) & (along >= 0.0)
    # Who is beside the vehicle now cannot be hit by its front.
    if along[0] < 0.0 or not in_the_way.any():
        return None
    return float(along[int(np.argmax(in_the_way))])
