"""Road users near the egos: read from SUMO once per step, as arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.interface import PedestrianPhase
from cosim.step.frames import heading_of
from cosim.sumo.network import Network
from cosim.sumo.present import Present, forget_absent

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
    uncertainty: FloatArray | None = None
    """Standard deviation of the positions, where they are what an ego believes [m]."""


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
    route: tuple[str, ...]
    """Id of the route; SUMO gives another one to a vehicle whose route changes."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """All road users near any ego at one instant, and the egos that each of them is near."""

    persons: Persons
    cars: Cars
    persons_near: Mapping[str, IntArray]
    """By ego: rows of ``persons``."""
    cars_near: Mapping[str, IntArray]
    """By ego: rows of ``cars``, without the ego itself."""


class KnownState(NamedTuple):
    """State of a vehicle that our plant knows better than SUMO."""

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
        self._last_persons: Mapping[str, Sequence[float]] = {}
        self._last_cars: Mapping[str, Sequence[float]] = {}
        at, on, following, self._rider_key = (sumo_constant(sumo, name) for name in _PERSON_VARIABLES)
        self._person_keys = (at, on, following)
        self._car_keys = tuple(sumo_constant(sumo, name) for name in _CAR_VARIABLES)

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

    def read(self, egos: Sequence[str], known: Mapping[str, KnownState], present: Present) -> Surroundings:
        """Return what is near these egos after the last step.

        Parameters
        ----------
        egos : names
        known : states to be believed instead of SUMO's, by name
        present : who is there; others that SUMO still names do not exist
        """
        sumo = self._sumo
        two, three, rider = self._person_keys[0], self._car_keys[0], self._rider_key
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
                if place is not None and _there(place) and name in present.persons and not values[rider]:
                    row = person_rows.get(name)
                    if row is None:
                        row = person_rows[name] = len(found_persons)
                        found_persons.append(values)
                    near_persons.append(row)
                place = values.get(three)
                if place is not None and _there(place) and name in present.vehicles:
                    row = car_rows.get(name)
                    if row is None:
                        row = car_rows[name] = len(found_cars)
                        found_cars.append(values)
                    if name != ego:
                        near_cars.append(row)
            persons_near[ego] = np.array(near_persons, dtype=np.int64)
            cars_near[ego] = np.array(near_cars, dtype=np.int64)
        forget_absent(self._person_kinds, present.persons)
        forget_absent(self._car_types, present.vehicles)
        return Surroundings(
            self._persons(tuple(person_rows), found_persons),
            self._cars(tuple(car_rows), found_cars, known),
            persons_near,
            cars_near,
        )

    def _persons(self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]]) -> Persons:
        sumo, known_crossings, kinds = self._sumo, self._network.crossings, self._person_kinds
        at, on, following = self._person_keys
        places = {name: values[at][:2] for name, values in zip(names, found, strict=True)}
        position = np.array(list(places.values()), dtype=np.float64).reshape(-1, 2)
        velocity = self._moved(position, names, self._last_persons)
        edges = tuple(values[on] for values in found)
        crossings, phases = [], []
        for edge, values in zip(edges, found, strict=True):
            if edge in known_crossings:
                crossings.append(edge)
                phases.append(PedestrianPhase.CROSSING.value)
                continue
            onward = values.get(following, "")
            is_next = onward in known_crossings
            crossings.append(onward if is_next else "")
            phases.append(PedestrianPhase.WAITING.value if is_next else PedestrianPhase.WALKING.value)
        for name in names:
            if name not in kinds:
                kinds[name] = sumo.person.getTypeID(name)
        # It is what the person really moved: SUMO's speed leaves out the lateral part, and its angle is that
        # of the lane. Whoever is new, or was put elsewhere between two lanes, has speed and angle only.
        unknown = ~(np.hypot(velocity[:, 0], velocity[:, 1]) <= MAX_WALKING_SPEED)
        for row in np.flatnonzero(unknown).tolist():
            speed = sumo.person.getSpeed(names[row])
            heading = heading_of(sumo.person.getAngle(names[row]))
            velocity[row] = speed * math.cos(heading), speed * math.sin(heading)
        self._last_persons = places
        return Persons(
            names,
            position,
            velocity,
            edges,
            tuple(crossings),
            np.array([phase == PedestrianPhase.CROSSING.value for phase in phases], dtype=np.bool_),
            tuple(phases),
            tuple(kinds[name] for name in names),
        )

    def _moved(
        self, position: FloatArray, names: Sequence[str], last: Mapping[str, Sequence[float]]
    ) -> FloatArray:
        """Return velocities from positions now and one step ago [m/s]; nan for the new ones."""
        before = np.array([last.get(name, _NOWHERE) for name in names], dtype=np.float64).reshape(-1, 2)
        return (position - before) / self._step

    def _cars(
        self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]], known: Mapping[str, KnownState]
    ) -> Cars:
        vehicle, types = self._sumo.vehicle, self._car_types
        at, speed, angle, acceleration, lane, lane_position, route = self._car_keys
        for name in names:
            if name not in types:
                size = (vehicle.getLength(name), vehicle.getWidth(name))
                types[name] = (*size, vehicle.getTypeID(name))
        rows = [
            (*values[at][:2], values[angle], values[speed], values[acceleration], values[lane_position])
            for values in found
        ]
        table = np.array(rows, dtype=np.float64).reshape(-1, 6)
        front, pace, change = table[:, 0:2].copy(), table[:, 3].copy(), table[:, 4].copy()
        heading = np.radians(90.0 - table[:, 2])
        own = [row for row, name in enumerate(names) if name in known]
        if own:
            states = np.array([known[names[row]] for row in own], dtype=np.float64)
            front[own] = states[:, 0:2]
            heading[own], pace[own], change[own] = states[:, 2], states[:, 3], states[:, 4]
        cosine, sine = np.cos(heading), np.sin(heading)
        velocity = self._moved(front, names, self._last_cars)
        ahead = np.column_stack([pace * cosine, pace * sine])
        # A plain lane change of SUMO's is a jump, and no speed; whoever is new has none of the last step.
        jumped = ~(np.abs(velocity - ahead).sum(axis=1) <= MAX_SIDEWAYS_SPEED)
        velocity[jumped] = ahead[jumped]
        self._last_cars = dict(zip(names, front.tolist(), strict=True))
        sizes = [types[name] for name in names]
        return Cars(
            names,
            front,
            velocity,
            np.arctan2(sine, cosine),
            pace,
            change,
            np.array([size[0] for size in sizes], dtype=np.float64),
            np.array([size[1] for size in sizes], dtype=np.float64),
            tuple(values[lane] for values in found),
            table[:, 5],
            tuple(size[2] for size in sizes),
            tuple(values[route] for values in found),
        )


def _there(place: Sequence[float]) -> bool:
    """Return whether a position is valid; SUMO gives absent road users a far one, or no number."""
    return abs(place[0]) < INVALID and abs(place[1]) < INVALID


_NOWHERE = (math.nan, math.nan)
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
    "VAR_ROUTE_ID",
)


def sumo_constant(sumo: Any, name: str) -> int:
    """Return one of SUMO's numbers; libsumo has them at its top, traci in a module."""
    value: int = getattr(sumo, name, None) or getattr(sumo.constants, name)
    return value
