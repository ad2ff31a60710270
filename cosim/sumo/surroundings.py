"""What SUMO says is near the egos: read once per step, as arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controllers.interface import PedestrianPhase
from cosim.frames import heading_of
from cosim.sumo.network import Network

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

PERSON_RANGE = 80.0
"""[m]"""
VEHICLE_RANGE = 100.0
"""[m]"""
PEDESTRIAN_RADIUS = 0.25
"""Assumed, see docs/conventions.md [m]."""
INVALID = 1e8
"""SUMO's coordinates of somebody who is nowhere are about −1e9 [m]."""


@dataclass(frozen=True, slots=True)
class Persons:
    """Pedestrians near any ego; riders of vehicles are not among them."""

    names: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray
    edge: tuple[str, ...]
    crossing: tuple[str, ...]
    """Crossing walked on or next; empty for none."""
    on_crossing: NDArray[np.bool_]
    phase: tuple[str, ...]
    kind: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Cars:
    """Vehicles near any ego, egos included."""

    names: tuple[str, ...]
    front: FloatArray
    velocity: FloatArray
    heading: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    length: FloatArray
    width: FloatArray
    lane: tuple[str, ...]
    lane_position: FloatArray
    kind: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Everything near any ego at one instant, and who is near whom."""

    persons: Persons
    cars: Cars
    persons_near: Mapping[str, IntArray]
    """By ego: rows of ``persons``."""
    cars_near: Mapping[str, IntArray]
    """By ego: rows of ``cars``, without the ego itself."""


@dataclass(frozen=True, slots=True)
class KnownState:
    """What our plant knows of a vehicle better than SUMO does."""

    x: float
    """Front bumper [m]."""
    y: float
    heading: float
    speed: float
    acceleration: float


class Observer:
    """Reads the surroundings of egos by context subscriptions.

    SUMO merges the results for persons and vehicles of one context by their ids. So the two ask for
    different variables: who has a two-dimensional position is a person, who has a three-dimensional one
    is a vehicle, and one id may be both.
    """

    def __init__(self, sumo: Any, network: Network, step: float) -> None:
        self._sumo = sumo
        self._network = network
        self._step = step
        self._person_kinds: dict[str, str] = {}
        self._car_types: dict[str, tuple[float, float, str]] = {}
        self._last_persons: dict[str, tuple[float, float]] = {}
        self._last_cars: dict[str, tuple[float, float]] = {}

    def follow(self, ego: str) -> None:
        """Begin to look around a vehicle."""
        sumo = self._sumo
        vehicle = sumo.vehicle
        person_variables = [sumo_constant(sumo, name) for name in _PERSON_VARIABLES]
        car_variables = [sumo_constant(sumo, name) for name in _CAR_VARIABLES]
        persons = sumo_constant(sumo, "CMD_GET_PERSON_VARIABLE")
        cars = sumo_constant(sumo, "CMD_GET_VEHICLE_VARIABLE")
        vehicle.subscribeContext(ego, persons, PERSON_RANGE, person_variables)
        vehicle.subscribeContext(ego, cars, VEHICLE_RANGE, car_variables)

    def leave(self, ego: str) -> None:
        """Stop looking around a vehicle that is still on the road."""
        sumo = self._sumo
        for name, reach in (
            ("CMD_GET_PERSON_VARIABLE", PERSON_RANGE),
            ("CMD_GET_VEHICLE_VARIABLE", VEHICLE_RANGE),
        ):
            sumo.vehicle.unsubscribeContext(ego, sumo_constant(sumo, name), reach)

    def read(self, egos: Sequence[str], known: Mapping[str, KnownState]) -> Surroundings:
        """Return what is near these egos after the last step.

        Parameters
        ----------
        egos : names
        known : states to be believed instead of SUMO's, by name
        """
        sumo = self._sumo
        two, three = sumo_constant(sumo, "VAR_POSITION"), sumo_constant(sumo, "VAR_POSITION3D")
        rider = sumo_constant(sumo, "VAR_VEHICLE")
        person_rows: dict[str, int] = {}
        car_rows: dict[str, int] = {}
        found_persons: list[Mapping[int, Any]] = []
        found_cars: list[Mapping[int, Any]] = []
        persons_near: dict[str, IntArray] = {}
        cars_near: dict[str, IntArray] = {}
        for ego in egos:
            near_persons: list[int] = []
            near_cars: list[int] = []
            for name, values in sumo.vehicle.getContextSubscriptionResults(ego).items():
                place = values.get(two)
                if place is not None and not values[rider] and abs(place[0]) < INVALID:
                    row = person_rows.get(name)
                    if row is None:
                        row = person_rows[name] = len(found_persons)
                        found_persons.append(values)
                    near_persons.append(row)
                place = values.get(three)
                if place is not None and abs(place[0]) < INVALID:
                    row = car_rows.get(name)
                    if row is None:
                        row = car_rows[name] = len(found_cars)
                        found_cars.append(values)
                    if name != ego:
                        near_cars.append(row)
            persons_near[ego] = np.array(near_persons, dtype=np.int64)
            cars_near[ego] = np.array(near_cars, dtype=np.int64)
        return Surroundings(
            self._persons(tuple(person_rows), found_persons),
            self._cars(tuple(car_rows), found_cars, known),
            persons_near,
            cars_near,
        )

    def _persons(self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]]) -> Persons:
        sumo = self._sumo
        at, on, following = (
            sumo_constant(sumo, name) for name in ("VAR_POSITION", "VAR_ROAD_ID", "VAR_NEXT_EDGE")
        )
        position = np.array([values[at][:2] for values in found]).reshape(-1, 2)
        velocity = np.zeros_like(position)
        edges, crossings, phases, kinds = [], [], [], []
        places: dict[str, tuple[float, float]] = {}
        known_crossings = self._network.crossings
        for row, (name, values) in enumerate(zip(names, found, strict=True)):
            place = values[at]
            velocity[row] = self._walked(name, (place[0], place[1]))
            places[name] = (place[0], place[1])
            edge = values[on]
            onward = values.get(following, "")
            if edge in known_crossings:
                crossing, phase = edge, PedestrianPhase.CROSSING
            elif onward in known_crossings:
                crossing, phase = onward, PedestrianPhase.WAITING
            else:
                crossing, phase = "", PedestrianPhase.WALKING
            kind = self._person_kinds.get(name)
            if kind is None:
                kind = self._person_kinds[name] = sumo.person.getTypeID(name)
            edges.append(edge)
            crossings.append(crossing)
            phases.append(phase.value)
            kinds.append(kind)
        self._last_persons = places
        return Persons(
            names,
            position,
            velocity,
            tuple(edges),
            tuple(crossings),
            np.array([phase == PedestrianPhase.CROSSING for phase in phases], dtype=np.bool_),
            tuple(phases),
            tuple(kinds),
        )

    def _walked(self, name: str, place: tuple[float, float]) -> tuple[float, float]:
        """Return the velocity of the last step.

        It is what the person really moved: SUMO's speed leaves out the lateral part, and its angle is that
        of the lane. Where SUMO puts a person elsewhere between two lanes, speed and angle are used.
        """
        before = self._last_persons.get(name)
        if before is not None:
            moved = ((place[0] - before[0]) / self._step, (place[1] - before[1]) / self._step)
            if math.hypot(*moved) <= MAX_WALKING_SPEED:
                return moved
        person = self._sumo.person
        speed, heading = person.getSpeed(name), heading_of(person.getAngle(name))
        return speed * math.cos(heading), speed * math.sin(heading)

    def _cars(
        self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]], known: Mapping[str, KnownState]
    ) -> Cars:
        sumo = self._sumo
        at, speed, angle, acceleration, lane, lane_position = (
            sumo_constant(sumo, name) for name in _CAR_VARIABLES
        )
        count = len(names)
        table = np.zeros((count, 9))
        lanes, kinds = [], []
        places: dict[str, tuple[float, float]] = {}
        for row, (name, values) in enumerate(zip(names, found, strict=True)):
            size = self._car_types.get(name)
            if size is None:
                vehicle = sumo.vehicle
                size = (vehicle.getLength(name), vehicle.getWidth(name), vehicle.getTypeID(name))
                self._car_types[name] = size
            own = known.get(name)
            if own is None:
                x, y = values[at][:2]
                heading = math.radians(90.0 - values[angle])
                pace, change = values[speed], values[acceleration]
            else:
                x, y, heading, pace, change = own.x, own.y, own.heading, own.speed, own.acceleration
            east, north = pace * math.cos(heading), pace * math.sin(heading)
            before = self._last_cars.get(name)
            if before is not None:
                moved = ((x - before[0]) / self._step, (y - before[1]) / self._step)
                # A plain lane change of SUMO's is a jump, and no speed.
                if abs(moved[0] - east) + abs(moved[1] - north) <= MAX_SIDEWAYS_SPEED:
                    east, north = moved
            places[name] = (x, y)
            table[row] = (x, y, east, north, heading, pace, change, size[0], size[1])
            lanes.append(values[lane])
            kinds.append(size[2])
        self._last_cars = places
        return Cars(
            names,
            table[:, 0:2],
            table[:, 2:4],
            np.arctan2(np.sin(table[:, 4]), np.cos(table[:, 4])),
            table[:, 5],
            table[:, 6],
            table[:, 7],
            table[:, 8],
            tuple(lanes),
            np.array([values[lane_position] for values in found]),
            tuple(kinds),
        )


MAX_WALKING_SPEED = 3.0
"""Faster persons were put elsewhere by SUMO [m/s]."""
MAX_SIDEWAYS_SPEED = 3.0
"""A position that changed by this much more than speed and heading explain was a jump [m/s]."""

_PERSON_VARIABLES = ("VAR_POSITION", "VAR_ROAD_ID", "VAR_NEXT_EDGE", "VAR_VEHICLE")
_CAR_VARIABLES = (
    "VAR_POSITION3D",
    "VAR_SPEED",
    "VAR_ANGLE",
    "VAR_ACCELERATION",
    "VAR_LANE_ID",
    "VAR_LANEPOSITION",
)


def sumo_constant(sumo: Any, name: str) -> int:
    """Return one of SUMO's numbers; libsumo has them at its top, traci in a module."""
    value: int = getattr(sumo, name, None) or getattr(sumo.constants, name)
    return value
