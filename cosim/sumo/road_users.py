"""Road users as SUMO has them: converts the results of subscriptions to arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.interface import PedestrianPhase
from cosim.arrays import FloatArray
from cosim.step.frames import heading_of
from cosim.sumo.network import Network
from cosim.sumo.present import Present, forget_absent

INVALID = 1e8
"""Coordinates this large are invalid: SUMO gives about −1e9 for absent road users [m]."""
MAX_WALKING_SPEED = 3.0
"""Persons who seem to walk faster than this were put elsewhere by SUMO [m/s]."""
MAX_SIDEWAYS_SPEED = 3.0
"""A vehicle jumped if its position changed by this much more than speed and heading explain [m/s]."""

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
_NOWHERE = (math.nan, math.nan)


@dataclass(frozen=True, slots=True)
class Persons:
    """Pedestrians near any ego; riders of vehicles are not among them."""

    names: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray
    edge: tuple[str, ...]
    crossing: tuple[str, ...]
    """Crossing that each walks on or will use next; empty for none."""
    on_crossing: NDArray[np.bool_]
    phase: tuple[str, ...]
    kind: tuple[str, ...]
    uncertainty: FloatArray | None = None
    """Standard deviation of the positions, if they are an ego's beliefs [m]."""


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
    """Id of the route; SUMO gives a vehicle another id if its route changes."""


class KnownState(NamedTuple):
    """State of a vehicle that its plant knows better than SUMO."""

    x: float
    """Front bumper [m]."""
    y: float
    heading: float
    speed: float
    acceleration: float


class PersonReader:
    """Reads pedestrians; remembers where each was a step ago, since SUMO's speed leaves out the lateral part.

    Parameters
    ----------
    sumo : module or connection
    network
    step : time between two readings [s]
    """

    def __init__(self, sumo: Any, network: Network, step: float) -> None:
        self._sumo = sumo
        self._crossings = network.crossings
        self._step = step
        self._kinds: dict[str, str] = {}
        self._last: Mapping[str, Sequence[float]] = {}
        self.variables = tuple(sumo_constant(sumo, name) for name in _PERSON_VARIABLES)
        """Variables to subscribe to."""
        self._at, self._on, self._following, self._rider = self.variables

    def is_there(self, values: Mapping[int, Any]) -> bool:
        """Return whether results belong to a person who has a position and is in no vehicle."""
        place = values.get(self._at)
        return place is not None and is_valid(place) and not values[self._rider]

    def read(self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]]) -> Persons:
        sumo, known_crossings, kinds = self._sumo, self._crossings, self._kinds
        at, on, following = self._at, self._on, self._following
        places = {name: values[at][:2] for name, values in zip(names, found, strict=True)}
        position = np.array(list(places.values()), dtype=np.float64).reshape(-1, 2)
        velocity = _moved(position, names, self._last, self._step)
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
        # This velocity is how the person really moved: SUMO's speed leaves out the lateral part, and its
        # angle is that of the lane. Persons who are new, or were put elsewhere between two lanes, only have
        # speed and angle.
        unknown = ~(np.hypot(velocity[:, 0], velocity[:, 1]) <= MAX_WALKING_SPEED)
        for row in np.flatnonzero(unknown).tolist():
            speed = sumo.person.getSpeed(names[row])
            heading = heading_of(sumo.person.getAngle(names[row]))
            velocity[row] = speed * math.cos(heading), speed * math.sin(heading)
        self._last = places
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

    def forget_absent(self, present: Present) -> None:
        """Forget the types of persons who are no longer there."""
        forget_absent(self._kinds, present.persons)


class CarReader:
    """Reads vehicles; remembers where each was a step ago.

    Parameters
    ----------
    sumo : module or connection
    step : time between two readings [s]
    """

    def __init__(self, sumo: Any, step: float) -> None:
        self._sumo = sumo
        self._step = step
        self._types: dict[str, tuple[float, float, str]] = {}
        self._last: Mapping[str, Sequence[float]] = {}
        self.variables = tuple(sumo_constant(sumo, name) for name in _CAR_VARIABLES)
        """Variables to subscribe to."""

    def is_there(self, values: Mapping[int, Any]) -> bool:
        """Return whether results belong to a vehicle that has a position."""
        place = values.get(self.variables[0])
        return place is not None and is_valid(place)

    def read(
        self, names: tuple[str, ...], found: Sequence[Mapping[int, Any]], known: Mapping[str, KnownState]
    ) -> Cars:
        vehicle, types = self._sumo.vehicle, self._types
        at, speed, angle, acceleration, lane, lane_position, route = self.variables
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
        velocity = _moved(front, names, self._last, self._step)
        ahead = np.column_stack([pace * cosine, pace * sine])
        # A plain lane change in SUMO is a jump, not a speed; a new vehicle has no position a step ago.
        jumped = ~(np.abs(velocity - ahead).sum(axis=1) <= MAX_SIDEWAYS_SPEED)
        velocity[jumped] = ahead[jumped]
        self._last = dict(zip(names, front.tolist(), strict=True))
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

    def forget_absent(self, present: Present) -> None:
        """Forget the types and sizes of vehicles that are no longer there."""
        forget_absent(self._types, present.vehicles)


def _moved(
    position: FloatArray, names: Sequence[str], last: Mapping[str, Sequence[float]], step: float
) -> FloatArray:
    """Return velocities from positions now and one step ago [m/s]; nan for new road users."""
    before = np.array([last.get(name, _NOWHERE) for name in names], dtype=np.float64).reshape(-1, 2)
    return (position - before) / step


def is_valid(place: Sequence[float]) -> bool:
    """Return whether a position is valid; SUMO gives absent road users a far-away one, or nan."""
    return abs(place[0]) < INVALID and abs(place[1]) < INVALID


def sumo_constant(sumo: Any, name: str) -> int:
    """Return one of SUMO's constants; libsumo has them at its top level, traci in a module."""
    value: int = getattr(sumo, name, None) or getattr(sumo.constants, name)
    return value
