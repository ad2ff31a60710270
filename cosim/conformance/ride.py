"""Drive an ego along a track and record what happens around it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from cosim.conformance.stage import Rectangle, rectangle, separation
from cosim.conformance.track import Pose
from cosim.step.frames import degrees_of
from cosim.sumo.placement import Executed


class Driver(Protocol):
    """Places a vehicle at a pose: `cosim.sumo.placement.Placement`, or a worse method for comparison."""

    def take_over(self, name: str) -> None:
        """Begin to drive."""
        ...

    def drive(self, name: str, front_x: float, front_y: float, heading: float, speed: float) -> None:
        """Say where the vehicle has to be after the next step."""
        ...

    def executed(self, name: str) -> Executed:
        """Return the vehicle's position, speed and lane in SUMO."""
        ...


class Moved:
    """A driver that uses ``moveToXY`` with parts of the recipe left out.

    Parameters
    ----------
    sumo : libsumo
    set_speed : also send the speed
    hint : edge and lane given to SUMO; empty for none
    keep_route : bits of ``moveToXY``
    speed_mode : SUMO's speed mode, set when the vehicle is taken over
    """

    def __init__(
        self,
        sumo: Any,
        set_speed: bool = True,
        hint: tuple[str, int] = ("", -1),
        keep_route: int = 2,
        speed_mode: int = 32,
    ) -> None:
        self._sumo = sumo
        self._set_speed = set_speed
        self._hint = hint
        self._keep_route = keep_route
        self._speed_mode = speed_mode

    def take_over(self, name: str) -> None:
        """Begin to drive."""
        self._sumo.vehicle.setSpeedMode(name, self._speed_mode)
        self._sumo.vehicle.setLaneChangeMode(name, 0)

    def drive(self, name: str, front_x: float, front_y: float, heading: float, speed: float) -> None:
        """Say where the vehicle has to be after the next step."""
        if self._set_speed:
            self._sumo.vehicle.setSpeed(name, speed)
        angle = degrees_of(heading)
        self._sumo.vehicle.moveToXY(name, *self._hint, front_x, front_y, angle, self._keep_route)

    def executed(self, name: str) -> Executed:
        """Return the vehicle's position, speed and lane in SUMO."""
        return _as_sumo_says(self._sumo, name)


class Native:
    """A driver that uses only ``setSpeed`` and ``changeSublane``, on a straight eastward road.

    Parameters
    ----------
    sumo : libsumo
    step : step length [s]
    agile : let the vehicle reach any lateral speed at once
    """

    def __init__(self, sumo: Any, step: float, agile: bool) -> None:
        self._sumo = sumo
        self._step = step
        self._agile = agile

    def take_over(self, name: str) -> None:
        """Begin to drive."""
        vehicle = self._sumo.vehicle
        vehicle.setSpeedMode(name, 32)
        vehicle.setLaneChangeMode(name, 0)
        if self._agile:
            vehicle.setMaxSpeedLat(name, 10.0)
            vehicle.setParameter(name, "laneChangeModel.lcAccelLat", "1000")
            vehicle.setParameter(name, "laneChangeModel.lcSigma", "0")

    def drive(self, name: str, front_x: float, front_y: float, heading: float, speed: float) -> None:
        """Say where the vehicle has to be after the next step."""
        x, y = self._sumo.vehicle.getPosition(name)
        self._sumo.vehicle.setSpeed(name, max(0.0, (front_x - x) / self._step))
        self._sumo.vehicle.changeSublane(name, front_y - y)

    def executed(self, name: str) -> Executed:
        """Return the vehicle's position, speed and lane in SUMO."""
        return _as_sumo_says(self._sumo, name)


def _as_sumo_says(sumo: Any, name: str) -> Executed:
    vehicle = sumo.vehicle
    x, y = vehicle.getPosition(name)
    return Executed(x, y, vehicle.getSpeed(name), vehicle.getLaneID(name))


@dataclass(slots=True)
class Ride:
    """What was observed during a ride."""

    error: float = 0.0
    """Largest distance between SUMO's position and the track [m]."""
    steps: int = 0
    lost: int = 0
    """Number of steps in which SUMO had the ego on no lane."""
    overlaps: int = 0
    """Number of steps in which the ego's true body overlapped a neighbour's."""
    reported: int = 0
    """Number of collisions that SUMO reported, counted in every step."""
    clearance: float = math.inf
    """Smallest distance between the ego's true body and a neighbour's, negative for an overlap [m]."""
    slowest: dict[str, float] = field(default_factory=dict)
    """Lowest speed of each neighbour [m/s]."""
    lanes: list[str] = field(default_factory=list)
    """SUMO's lane after each step."""


def ride(
    sumo: Any,
    driver: Driver,
    pose_at: Callable[[float], Pose],
    duration: float,
    neighbours: Sequence[str] = (),
    each: Callable[[float, Pose, Executed], None] | None = None,
    name: str = "ego",
) -> Ride:
    """Take the vehicle over and drive it along ``pose_at(time)`` [s] for ``duration`` [s].

    The result refers to the ego's prescribed body, because SUMO's may be wrong.
    """
    seen = Ride()
    step = sumo.simulation.getDeltaT()
    length, width = sumo.vehicle.getLength(name), sumo.vehicle.getWidth(name)
    driver.take_over(name)
    for number in range(1, round(duration / step) + 1):
        pose = pose_at(number * step)
        driver.drive(name, *pose)
        sumo.simulationStep()
        found = driver.executed(name)
        seen.steps += 1
        seen.error = max(seen.error, math.dist((pose.x, pose.y), (found.x, found.y)))
        seen.lost += not found.lane
        seen.lanes.append(found.lane)
        seen.reported += len(sumo.simulation.getCollisions())
        _look(sumo, seen, (pose.x, pose.y, pose.heading, length, width), neighbours)
        if each is not None:
            each(number * step, pose, found)
    return seen


def _look(sumo: Any, seen: Ride, ego: Rectangle, neighbours: Sequence[str]) -> None:
    present = set(sumo.vehicle.getIDList()) if neighbours else set()
    closest = math.inf
    for other in neighbours:
        if other in present:
            closest = min(closest, separation(ego, rectangle(sumo, other)))
            speed = sumo.vehicle.getSpeed(other)
            seen.slowest[other] = min(seen.slowest.get(other, math.inf), speed)
    seen.clearance = min(seen.clearance, closest)
    seen.overlaps += closest < 0.0
