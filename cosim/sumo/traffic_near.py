"""The vehicles near scripted pedestrians, with the path that each will drive.

SUMO can report what is near a point of interest, as it can for a vehicle. Therefore every scripted pedestrian
is a point of interest, which also shows them in SUMO's window.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import RoadUser, Way
from cosim.step.frames import heading_of
from cosim.sumo.egos import ROADLESS_CLASSES
from cosim.sumo.network import Network
from cosim.sumo.path import Path, project_all
from cosim.sumo.road_users import INVALID, sumo_constant

NEAR = 100.0
"""Vehicles are read within this distance of a pedestrian [m]."""
REACH = 120.0
"""A vehicle's way is known this far ahead [m]."""
_COLOUR = (255, 120, 0, 255)
_LAYER = 200


@dataclass(frozen=True, slots=True)
class Body:
    """Properties of a vehicle that its SUMO type gives."""

    length: float
    width: float
    min_gap: float
    """Distance that it keeps to whatever it stops for [m]."""
    comfortable: float
    """Comfortable deceleration [m/s^2]."""
    hardest: float
    """Emergency deceleration [m/s^2]."""
    rails: bool
    """Whether it cannot be stopped as a road vehicle can."""


class TrafficNear:
    """Reads the vehicles near any scripted pedestrian, once per step.

    Parameters
    ----------
    sumo : module or connection
    network
    """

    def __init__(self, sumo: Any, network: Network) -> None:
        self._sumo = sumo
        self._network = network
        self._bodies: dict[str, Body] = {}
        self._ways: dict[tuple[str, ...], Path] = {}
        names = ("VAR_POSITION3D", "VAR_SPEED", "VAR_ANGLE", "VAR_LANE_ID")
        self._keys = tuple(sumo_constant(sumo, name) for name in names)
        self._domain = sumo_constant(sumo, "CMD_GET_VEHICLE_VARIABLE")

    def watch(self, name: str, x: float, y: float) -> None:
        """Begin to look around a pedestrian."""
        poi = self._sumo.poi
        poi.add(name, x, y, _COLOUR, "pedestrian", _LAYER)
        poi.subscribeContext(name, self._domain, NEAR, list(self._keys))

    def move(self, name: str, x: float, y: float) -> None:
        """Move the place around which to look."""
        self._sumo.poi.setPosition(name, x, y)

    def leave(self, name: str) -> None:
        """Stop looking around a pedestrian."""
        self._sumo.poi.unsubscribeContext(name, self._domain, NEAR)
        self._sumo.poi.remove(name)

    def body(self, vehicle: str) -> Body:
        """Return the properties of a vehicle."""
        found = self._bodies.get(vehicle)
        if found is None:
            of = self._sumo.vehicle
            found = self._bodies[vehicle] = Body(
                of.getLength(vehicle),
                of.getWidth(vehicle),
                of.getMinGap(vehicle),
                of.getDecel(vehicle),
                of.getEmergencyDecel(vehicle),
                of.getVehicleClass(vehicle) in ROADLESS_CLASSES,
            )
        return found

    def read(self, pedestrians: Sequence[str]) -> dict[str, list[RoadUser]]:
        """Return the road vehicles near each pedestrian after the last step."""
        known: dict[str, RoadUser | None] = {}
        found: dict[str, list[RoadUser]] = {}
        at, speed, angle, lane = self._keys
        # The results still contain vehicles that were taken off the road after the step.
        there = set(self._sumo.vehicle.getIDList()) if pedestrians else set()
        for pedestrian in pedestrians:
            near: list[RoadUser] = []
            for name, values in self._sumo.poi.getContextSubscriptionResults(pedestrian).items():
                if name not in there:
                    continue
                if name not in known:
                    x, y = values[at][:2]
                    known[name] = self._user(name, x, y, values[angle], values[speed], values[lane])
                user = known[name]
                if user is not None:
                    near.append(user)
            found[pedestrian] = near
        return found

    def around(self, x: float, y: float) -> list[RoadUser]:
        """Return the road vehicles near a place that is not watched yet: SUMO reports only after a step."""
        of, found = self._sumo.vehicle, []
        for name in of.getIDList():
            at_x, at_y = of.getPosition(name)
            if math.dist((at_x, at_y), (x, y)) <= NEAR:
                angle, speed, lane = of.getAngle(name), of.getSpeed(name), of.getLaneID(name)
                found.append(self._user(name, at_x, at_y, angle, speed, lane))
        return [user for user in found if user is not None]

    def _user(self, name: str, x: float, y: float, angle: float, speed: float, lane: str) -> RoadUser | None:
        body = self.body(name)
        if abs(x) >= INVALID or body.rails:
            return None
        way = self._way(name, x, y, lane)
        return RoadUser(name, x, y, heading_of(angle), max(speed, 0.0), body.length, body.width, way)

    def _way(self, name: str, x: float, y: float, lane: str) -> Way | None:
        lanes = self._lanes_ahead(name, lane)
        if not lanes:
            return None
        if lanes not in self._ways:
            shape = np.concatenate([self._network.lanes[one].shape for one in lanes])
            apart = np.concatenate([[True], np.hypot(*np.diff(shape, axis=0).T) > 1e-3])
            self._ways[lanes] = Path(shape[apart])
        return way_along(self._ways[lanes], x, y)

    def _lanes_ahead(self, name: str, lane: str) -> tuple[str, ...]:
        """Return the vehicle's lane and the lanes that it will drive on, as far as they are known."""
        network = self._network
        if lane not in network.lanes:
            return ()
        lanes = [lane]
        through = network.through.get(lane)
        if through is not None:
            lanes += [*through.via[through.via.index(lane) + 1 :], through.target]
        ahead = sum(network.lanes[one].length for one in lanes[1:])
        ahead += network.lanes[lane].length - self._sumo.vehicle.getLanePosition(name)
        for link in self._sumo.vehicle.getNextLinks(name):
            target, inner = link[0], link[4]
            if ahead > REACH:
                break
            if target in lanes or target not in network.lanes:
                continue
            connection = network.through.get(inner)
            via = connection.via if connection is not None else ()
            lanes += [*via, target]
            ahead += sum(network.lanes[one].length for one in (*via, target))
        return tuple(lanes)


def way_along(path: Path, x: float, y: float, near: float = 0.0) -> Way:
    """Return a function that locates points relative to a vehicle on its path, with its front at (x, y).

    Parameters
    ----------
    path
    x, y : position of the front bumper [m]
    near : about where on the path that is; it decides if the path comes to the same place again [m]
    """
    alongs, acrosses, _ = project_all([path], np.array([[x, y]]), [1], [near])
    front, beside = float(alongs[0]), float(acrosses[0])

    def sees(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        alongs, acrosses = path.project_again(points, front)
        return alongs - front, acrosses - beside

    return sees
