"""Keeps a vehicle in SUMO where the plant is, so that SUMO's traffic reacts to it as to SUMO's own vehicles.

``hybrid`` lets SUMO drive the given speed and lateral shift on normal lanes and moves the vehicle to its
position only where that cannot work: in junctions, at lane ends and off the paved lanes. ``move`` moves it
at every step. docs/coupling.md gives measurements of what each does to neighbours and pedestrians.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NamedTuple

from cosim.errors import SimulationError
from cosim.step.frames import degrees_of
from cosim.sumo.lane_shape import LaneShape
from cosim.sumo.lanes import Lanes
from cosim.sumo.own_route import OwnRoute, RouteKeeper

OBEY_SPEED = 32
"""Speed mode: SUMO checks nothing by itself. Bit 5 is inverted: set, it ignores foes in the junction."""
OBEY_LANE = 0
"""Lane-change mode: SUMO neither decides nor corrects lateral movements."""
EXACT_POSITION = 2
"""``keepRoute`` of moveToXY: take the position as it is. 6 (with 4, ignore permissions) can crash SUMO."""
ON_ROUTE = 3
"""As `EXACT_POSITION`, but only lanes of the route count near the position, whichever lane is given."""

POSITION_TOLERANCE = 0.02
"""If the ego is further from the plant after a native step, it is moved until its lane changes [m]."""
DITHER = 0.002
"""Extra lateral shift [m] in the first native step after a move.

Neither a move nor a shift of zero registers the vehicle in the second lane that it reaches into.
"""
SIDEWAYS = 0.01
"""A native step shifts the ego sideways by no more than the distance ahead plus this [m].

No car needs more. A larger shift means that SUMO has a moved vehicle on the other side of its lane, which
happens where traffic keeps left.
"""
_BLIND_PARAMETERS = (("laneChangeModel.lcAccelLat", "1000"), ("laneChangeModel.lcSigma", "0"))
_LATERAL_SPEED = 10.0


class Method(StrEnum):
    """Methods by which SUMO's ego follows the plant: the values of the parameter ``actuation``."""

    HYBRID = "hybrid"
    MOVE = "move"


class Executed(NamedTuple):
    """Position of the ego in SUMO."""

    x: float
    """Centre of the front bumper [m]."""
    y: float
    speed: float
    lane: str
    """Lane id; empty if SUMO has it on no lane."""


@dataclass(slots=True)
class _Ego:
    """What is remembered of one driven vehicle."""

    vehicle_class: str
    width: float
    speed_mode: int
    lane_mode: int
    lateral_speed: float
    parameters: tuple[tuple[str, str], ...]
    lane: str
    """Lane on which it is believed to be."""
    speed: float
    """Speed at the beginning of the step [m/s]."""
    route: OwnRoute
    moved: bool = False
    """Whether the last step was a move."""
    moves_on: str = ""
    """Lane on which native driving failed; the ego is moved until it is on another lane."""
    aim: tuple[float, float] | None = None
    """Where the front bumper has to be after the present step [m]."""
    asked_speed: float = 0.0
    moves: int = 0
    strayed: float = 0.0
    """Distance from the plant's front bumper to where SUMO's was put in the last move [m]."""


class Placement:
    """Drives any number of vehicles in SUMO.

    Parameters
    ----------
    connection : the ``libsumo`` module, or a ``traci`` connection
    step : length of a simulation step [s]
    method : how the vehicles follow their plants
    dither : see `DITHER`; only the conformance suite has a reason to change it [m]

    Raises
    ------
    SimulationError
        If hybrid actuation is requested without SUMO's sublane model.
    """

    def __init__(
        self, connection: Any, step: float, method: Method = Method.HYBRID, dither: float = DITHER
    ) -> None:
        if method is Method.HYBRID and float(connection.simulation.getOption("lateral-resolution")) <= 0.0:
            raise SimulationError(
                "hybrid actuation needs SUMO's sublane model: lateral-resolution 0.4 m or a similar value, "
                "found 0; without it choose actuation move"
            )
        self._connection = connection
        self._step = step
        self._method = method
        self._dither = dither
        self._lanes = Lanes(connection)
        self._egos: dict[str, _Ego] = {}
        self._routes = RouteKeeper(connection, self._lanes)

    def take_over(self, name: str) -> None:
        """Begin to drive a vehicle that is on the road; SUMO no longer decides anything for it.

        Raises
        ------
        SimulationError
            If the vehicle is not on a lane.
        """
        vehicle = self._connection.vehicle
        lane = vehicle.getLaneID(name)
        if not lane:
            raise SimulationError(f"vehicle {name} cannot be taken over: it is not on a lane")
        hybrid = self._method is Method.HYBRID
        self._egos[name] = _Ego(
            vehicle_class=vehicle.getVehicleClass(name),
            width=vehicle.getWidth(name),
            speed_mode=vehicle.getSpeedMode(name),
            lane_mode=vehicle.getLaneChangeMode(name),
            lateral_speed=vehicle.getMaxSpeedLat(name),
            parameters=tuple((key, vehicle.getParameter(name, key)) for key, _ in _BLIND_PARAMETERS)
            if hybrid
            else (),
            lane=lane,
            speed=vehicle.getSpeed(name),
            route=self._routes.of(name),
        )
        vehicle.setSpeedMode(name, OBEY_SPEED)
        vehicle.setLaneChangeMode(name, OBEY_LANE)
        if hybrid:
            vehicle.setMaxSpeedLat(name, _LATERAL_SPEED)
            for key, value in _BLIND_PARAMETERS:
                vehicle.setParameter(name, key, value)

    def drive(
        self, name: str, front_x: float, front_y: float, heading: float, speed: float, lane: str = ""
    ) -> None:
        """Set where the vehicle has to be after the next step; call it once before every step.

        Parameters
        ----------
        front_x, front_y : centre of the front bumper after the step [m]
        heading : heading after the step [rad]
        speed : speed after the step [m/s]
        lane : lane that it will be on; needed where its way cuts a corner and passes no lane's end
        """
        ego = self._ego(name)
        ego.aim = (front_x, front_y)
        found = self._connection.vehicle.getLaneID(name)
        if found and found != ego.moves_on:
            ego.moves_on = ""
        believed = self._lanes.shape(ego.lane)
        # After a move, SUMO may have the vehicle on a crossing lane; a lane beside its own is acceptable.
        trusted = bool(found) and not ego.route.astray
        trusted = trusted and (not ego.moved or self._lanes.shape(found).edge == believed.edge)
        here = self._lanes.shape(found) if trusted else believed
        there = self._lanes.shape(lane) if lane else None
        native = trusted and self._method is Method.HYBRID and (there is None or there.edge == here.edge)
        if not native or not self._native(name, ego, here, ego.aim, speed):
            self._move(name, ego, here, there, ego.aim, trusted, heading, speed)
        ego.speed = speed

    def executed(self, name: str) -> Executed:
        """Return where SUMO has the vehicle after the step, and repair what the step broke.

        A route that is no longer the ego's own is set again. If the position is off by more than
        `POSITION_TOLERANCE`, the next steps are moves.
        """
        ego = self._ego(name)
        vehicle = self._connection.vehicle
        x, y = vehicle.getPosition(name)
        lane = vehicle.getLaneID(name)
        if ego.aim is not None:
            if ego.moved or ego.route.astray or self._routes.changed(name, ego.route):
                self._routes.keep(name, ego.route, lane, ego.lane, ego.moved)
            if not ego.moved:
                ego.lane = lane or ego.lane
                if math.dist((x, y), ego.aim) > POSITION_TOLERANCE:
                    ego.moves_on = lane
            ego.aim = None
        return Executed(x, y, vehicle.getSpeed(name), lane)

    def asked_speed(self, name: str) -> float:
        """Return the speed [m/s] that SUMO was told to drive in the last step.

        It is the distance of the step divided by its duration, which differs from the speed at the end by
        half the acceleration times the step. `Executed.speed` therefore has to be compared with this speed.
        """
        return self._ego(name).asked_speed

    def moves(self, name: str) -> int:
        """Return in how many steps so far the vehicle was moved instead of driven natively."""
        return self._ego(name).moves

    def routes_restored(self, name: str) -> int:
        """Return how often the rest of the route had to be set again after a move."""
        return self._ego(name).route.restored

    @property
    def routes_restored_of_all(self) -> int:
        """How often a route of any vehicle had to be set again so far."""
        return self._routes.restored_of_all

    def astray(self, name: str) -> bool:
        """Return whether, after the last step, SUMO had another route or had the ego on a lane off its way.

        If this could be corrected at once, it has been; otherwise the next step is a move that corrects it.
        """
        return self._ego(name).route.astray

    def strayed(self, name: str) -> float:
        """Return how far from the plant the vehicle was put because SUMO cannot place it there [m]."""
        return self._ego(name).strayed

    def drives(self, name: str) -> bool:
        """Return whether the placement drives the vehicle at the moment."""
        return name in self._egos

    def reroute(self, name: str, edges: Sequence[str]) -> bool:
        """Give a vehicle another route from the edge it is on, and return whether SUMO takes it.

        The vehicle may be one that has been handed back.
        """
        ego = self._egos.get(name)
        return self._routes.reroute(name, edges, None if ego is None else ego.route)

    def release(self, name: str) -> None:
        """Hand the vehicle back to SUMO's driver, with everything as `take_over` found it."""
        ego = self._ego(name)
        vehicle = self._connection.vehicle
        vehicle.setSpeed(name, -1.0)
        vehicle.setSpeedMode(name, ego.speed_mode)
        vehicle.setLaneChangeMode(name, ego.lane_mode)
        if self._method is Method.HYBRID:
            vehicle.setMaxSpeedLat(name, ego.lateral_speed)
            for key, value in ego.parameters:
                vehicle.setParameter(name, key, value)
        self.forget(name)

    def forget(self, name: str) -> None:
        """Drop a vehicle that has left the road."""
        self._egos.pop(name, None)

    def _ego(self, name: str) -> _Ego:
        found = self._egos.get(name)
        if found is None:
            known = ", ".join(self._egos) or "none"
            raise SimulationError(f"vehicle {name} is not driven from here; those that are: {known}")
        return found

    def _native(self, name: str, ego: _Ego, here: LaneShape, aim: tuple[float, float], speed: float) -> bool:
        """Let SUMO drive the vehicle there if it can, and return whether it does."""
        if here.internal or here.name == ego.moves_on:
            return False
        place = here.place(*aim)
        inside = abs(place.across) <= 0.5 * here.width
        if inside and here.drawn_off(place, *aim) > POSITION_TOLERANCE:
            return False  # the wedge outside a corner of the lane's shape, into which SUMO cannot drive
        if not 0.0 <= place.along < here.shape_length or not self._lanes.paved(
            here, ego.vehicle_class, ego.width, place.across
        ):
            return False
        target = self._lanes.counted(here, place, ego.vehicle_class, *aim)
        if target is None:
            return False
        position, across = target
        vehicle = self._connection.vehicle
        asked = (position - vehicle.getLanePosition(name)) / self._step
        slowest, fastest = sorted((ego.speed, speed))
        if not 0.9 * slowest - 0.2 <= asked <= 1.1 * fastest + 0.2:
            return False
        shift = across - vehicle.getLateralLanePosition(name)
        if abs(shift) > max(asked, 0.0) * self._step + SIDEWAYS:
            return False
        shift += self._dither if ego.moved else 0.0
        ego.asked_speed = max(0.0, asked)  # a negative speed would hand the vehicle back to SUMO's driver
        vehicle.setSpeed(name, ego.asked_speed)
        vehicle.changeSublane(name, shift)
        ego.moved = False
        ego.strayed = 0.0
        return True

    def _move(
        self,
        name: str,
        ego: _Ego,
        here: LaneShape,
        there: LaneShape | None,
        aim: tuple[float, float],
        trusted: bool,
        heading: float,
        speed: float,
    ) -> None:
        """Move the vehicle there, with the lane of its route as the hint."""
        vehicle, route = self._connection.vehicle, ego.route
        if not ego.moved and not route.astray:
            self._routes.take(name, route)
        ego.asked_speed = speed
        if there is None:
            there, way = self._lanes.reach(here, route.ahead, ego.vehicle_class, *aim)
            if self._method is Method.HYBRID and trusted:
                rate = (way - vehicle.getLanePosition(name)) / self._step
                slowest, fastest = sorted((ego.speed, speed))
                ego.asked_speed = min(max(rate, 0.9 * slowest), 1.1 * fastest)
        vehicle.setSpeed(name, ego.asked_speed)
        x, y, angle, keep = *aim, heading, ON_ROUTE
        if route.left or not self._lanes.found_on_route(there, route.driven, route.ahead, ego.width, *aim):
            x, y, angle = self._lanes.placeable(there, ego.width, *aim, heading, route.astray)
            keep = EXACT_POSITION
        ego.strayed = math.dist((x, y), aim)
        vehicle.moveToXY(name, there.edge, there.index, x, y, degrees_of(angle), keep)
        ego.lane = there.name
        ego.moved = True
        ego.moves += 1
