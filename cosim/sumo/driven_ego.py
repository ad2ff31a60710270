"""A vehicle of SUMO that a controller drives: its state, and what SUMO must no longer decide for it."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from controllers.driving.standing import VEHICLE_STANDING
from controllers.interface import Command, constant_command
from cosim.step.plant import Plant
from cosim.step.world import EgoTruth
from cosim.sumo.changed_limits import ROUNDING
from cosim.sumo.detours import on_a_lane_off_the_route
from cosim.sumo.network import NetLane
from cosim.sumo.placement import Executed
from cosim.sumo.track import Track
from cosim.sumo.view import Frame

COAST = constant_command(0.0, 0.0)


@dataclass(slots=True)
class DrivenEgo:
    """A vehicle of SUMO that a controller drives."""

    name: str
    plant: Plant
    track: Track
    executed: Executed
    own_limit: float
    """Highest speed of this type of vehicle [m/s]."""
    front: tuple[float, float]
    """Centre of the front bumper after the last step [m]."""
    command: Command = COAST
    elapsed: float = 0.0
    """Time since the command was given [s]."""
    travelled: float = 0.0
    intervention: str = ""
    """Why SUMO's state differs from the plant's after the last step; empty if it does not."""
    handed_back: bool = False
    astray_for: float = 0.0
    """How long the vehicle's route in SUMO has differed from the ego's own [s]."""
    stood_for: float = 0.0
    """How long the ego has stood [s]."""
    stood_off_the_route_for: float = 0.0
    """How long it has stood on a lane that leads off its route, since it last looked for a detour [s]."""
    given_up: bool = False
    """Whether it was handed back for good because it had left its way or stood for too long."""
    frame: Frame | None = None
    """Its frame when it was last sensed."""

    def count_standing(self, step: float) -> None:
        """After a step [s], update how long it has stood, in all and on a lane that leads off its route."""
        standing = self.executed.speed < VEHICLE_STANDING
        self.stood_for = self.stood_for + step if standing else 0.0
        off_the_route = standing and on_a_lane_off_the_route(self.track)
        self.stood_off_the_route_for = self.stood_off_the_route_for + step if off_the_route else 0.0

    def truth(self, step: float, changed_limits: Mapping[str, float]) -> EgoTruth:
        """Return what is recorded of it after a step.

        Parameters
        ----------
        step : length of the step [s]
        changed_limits : limits of lanes where they now differ from those of the network, by lane [m/s]
        """
        plant, track = self.plant, self.track
        entry = 0
        if len(self.command.times) > 1:
            # The entry of the command that was carried out in the last step.
            began = self.elapsed - step + 1e-9
            entry = max(0, bisect_right(self.command.times, began) - 1)
        x, y = self.front
        piece = track.path.piece_at(track.along)
        return EgoTruth(
            name=self.name,
            body=plant.body,
            x=x,
            y=y,
            heading=plant.heading,
            speed=plant.speed,
            acceleration=plant.acceleration,
            steering=plant.steering,
            edge=piece.lane.edge,
            lane=self.executed.lane,
            route_position=self.travelled,
            speed_limit=min(
                piece.lane.limit(track.route.vehicle_class, changed_limits.get(piece.lane.name)),
                self.own_limit,
            ),
            commanded_acceleration=float(self.command.acceleration[entry]),
            commanded_steering=float(self.command.steering[entry]),
            executed_x=self.executed.x,
            executed_y=self.executed.y,
            executed_speed=self.executed.speed,
            intervention_cause=self.intervention or None,
            handed_back=self.handed_back,
        )


def own_limit(sumo: Any, name: str, lane: NetLane) -> float:
    """Return the highest speed of a vehicle's type on a road without a limit [m/s].

    SUMO reports ``maxSpeed`` but not ``desiredMaxSpeed``, which keeps a bicycle at 20 km/h. The latter shows
    in the speed that SUMO allows the vehicle on a lane that allows more.

    Parameters
    ----------
    sumo, name : the vehicle in SUMO
    lane : the lane that it is on, which may have a limit of its own for the vehicle's class
    """
    vehicle = sumo.vehicle
    possible: float = vehicle.getMaxSpeed(name)
    factor: float = vehicle.getSpeedFactor(name)
    allowed: float = vehicle.getAllowedSpeed(name)
    limit: float = sumo.lane.getMaxSpeed(lane.name)
    own = lane.class_speeds.get(vehicle.getVehicleClass(name))
    if own is None:
        on_lane = min(limit * factor, possible)
    else:
        # A sign that changes the limit of the lane holds without the vehicle's factor then.
        on_lane = min(own * factor, possible, math.inf if abs(limit - lane.speed) <= ROUNDING else limit)
    return min(possible, allowed / factor) if allowed < on_lane - 1e-6 else possible


def is_on_lane(sumo: Any, name: str) -> bool:
    """Return whether a vehicle drives on an edge: not parked, waiting at a stop or inside a junction."""
    vehicle = sumo.vehicle
    lane = vehicle.getLaneID(name)
    return bool(lane) and not lane.startswith(":") and not vehicle.isStopped(name)


def let_go(sumo: Any, name: str) -> None:
    """Remove what SUMO would make a vehicle do besides driving its route: stops and rerouting."""
    vehicle = sumo.vehicle
    for _ in vehicle.getStops(name):
        vehicle.replaceStop(name, 0, "")
    if vehicle.getParameter(name, "has.rerouting.device") == "true":
        vehicle.setParameter(name, "device.rerouting.period", "0")
