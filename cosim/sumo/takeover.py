"""Turns vehicles of SUMO into egos."""

from __future__ import annotations

from typing import Any

from controllers.interface import Drive
from cosim.step.frames import heading_of, rear_axle_of
from cosim.step.plant import Plant, body_of
from cosim.sumo.bends import Turning, turning_of
from cosim.sumo.driven_ego import DrivenEgo, own_limit
from cosim.sumo.network import Network
from cosim.sumo.placement import Executed
from cosim.sumo.shared_routes import SharedRoutes
from cosim.sumo.track import Track


class Takeover:
    """Turns vehicles of SUMO into egos; egos with the same route share it.

    Parameters
    ----------
    network
    drive : actuators of every ego
    """

    def __init__(self, network: Network, drive: Drive) -> None:
        self._drive = drive
        self._network = network
        self._routes = SharedRoutes(network)

    def ego_of(self, sumo: Any, name: str) -> DrivenEgo:
        """Return the ego that a vehicle becomes: at the same place and speed, and on the same route.

        Raises
        ------
        InputError
            If the route cannot be driven.
        """
        vehicle = sumo.vehicle
        body = body_of(vehicle.getLength(name), vehicle.getWidth(name))
        now = seen(sumo, name)
        track = self.track_of(sumo, name, now, turning_of(body, self._drive))
        heading = heading_of(vehicle.getAngle(name))
        rear = rear_axle_of(now.x, now.y, heading, body.front)
        lane = self._network.lanes[now.lane]
        plant = Plant(body, self._drive, *rear, heading, now.speed)
        return DrivenEgo(name, plant, track, now, own_limit(sumo, name, lane), plant.front)

    def track_of(
        self, sumo: Any, name: str, now: Executed, turning: Turning, before: Track | None = None
    ) -> Track:
        """Return a vehicle's place on the route that it has now.

        Parameters
        ----------
        sumo, name : the vehicle in SUMO
        now : where SUMO has the vehicle
        turning : how tightly the vehicle turns
        before : where the vehicle was on its route until now, if it had one already

        Raises
        ------
        InputError
            If the route cannot be driven.
        """
        vehicle = sumo.vehicle
        edges, kind = tuple(vehicle.getRoute(name)), vehicle.getVehicleClass(name)
        route = self._routes.route(edges, kind, turning)
        index = vehicle.getLaneIndex(name)
        if before is not None and vehicle.getRoadID(name).startswith(":"):
            index = before.index  # inside a junction, that of the lane before it
        track = Track(route, vehicle.getRouteIndex(name), index)
        track.update(now.x, now.y)
        track.number = 0 if before is None else before.number
        return track


def seen(sumo: Any, name: str) -> Executed:
    """Return where SUMO has a vehicle."""
    vehicle = sumo.vehicle
    x, y = vehicle.getPosition(name)
    return Executed(x, y, vehicle.getSpeed(name), vehicle.getLaneID(name))
