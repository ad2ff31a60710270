"""The seam between the step and what it drives: SUMO, or a road without SUMO."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np

from controllers.interface import Body, Command, Perception
from cosim.arrays import FloatArray
from cosim.sensing.interface import Sensed


@dataclass(frozen=True, slots=True, kw_only=True)
class EgoTruth:
    """One ego after a step, as it really is: the plant's state, and what SUMO made of it.

    What of it is recorded, and under which name, ``analysis/recording/columns.py`` says.
    """

    name: str
    body: Body
    x: float
    """Centre of the front bumper [m]."""
    y: float
    heading: float
    speed: float
    acceleration: float
    steering: float
    edge: str
    lane: str
    """SUMO's lane id; empty where SUMO lost it."""
    route_position: float
    """Distance travelled since the ego was taken over [m]."""
    speed_limit: float
    commanded_acceleration: float
    commanded_steering: float
    executed_x: float
    """Front bumper where SUMO says it is after the step [m]."""
    executed_y: float
    executed_speed: float
    intervention_cause: str | None = None
    """Why SUMO's position or speed differs from the plant's by more than 0.02 m or 0.1 m/s, one of
    ``INTERVENTIONS`` in ``analysis/recording/columns.py``; ``None``: it does not."""
    handed_back: bool = False

    @property
    def intervention(self) -> bool:
        """Whether SUMO did something else than the plant."""
        return self.intervention_cause is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonsTruth:
    """All pedestrians near any ego; arrays of length n. Riders of vehicles are not among them."""

    object_kind: ClassVar[str] = "pedestrian"

    names: tuple[str, ...]
    x: FloatArray
    """Centre of the disc [m]."""
    y: FloatArray
    x_speed: FloatArray
    y_speed: FloatArray
    radius: FloatArray
    place: tuple[str, ...]
    """Edge walked on."""
    crossing: tuple[str | None, ...]
    """Crossing walked on, or next edge when that is a crossing."""
    phase: tuple[str, ...]
    """``PedestrianPhase`` values."""
    kind: tuple[str, ...]
    """SUMO type id."""
    signal: tuple[str | None, ...] | None = None
    """``green`` or ``red``: that crossing's light for pedestrians; ``None`` where there is none, or where
    nobody asked for it."""

    @property
    def heading(self) -> list[float | None]:
        """Direction of motion; ``None`` for a standing pedestrian [rad]."""
        return [
            math.atan2(v, u) if u or v else None
            for u, v in zip(self.x_speed.tolist(), self.y_speed.tolist(), strict=True)
        ]

    @property
    def length(self) -> FloatArray:
        """Diameter [m]."""
        return 2.0 * self.radius

    @property
    def width(self) -> FloatArray:
        """Diameter [m]."""
        return 2.0 * self.radius


@dataclass(frozen=True, slots=True, kw_only=True)
class VehiclesTruth:
    """All other vehicles near any ego; arrays of length n."""

    object_kind: ClassVar[str] = "vehicle"
    crossing: ClassVar[None] = None
    phase: ClassVar[None] = None
    signal: ClassVar[None] = None

    names: tuple[str, ...]
    x: FloatArray
    """Centre of the front bumper [m]."""
    y: FloatArray
    heading: FloatArray
    speed: FloatArray
    length: FloatArray
    width: FloatArray
    place: tuple[str, ...]
    """Lane driven on."""
    kind: tuple[str, ...]

    @property
    def x_speed(self) -> FloatArray:
        """[m/s]."""
        return np.asarray(self.speed * np.cos(self.heading))

    @property
    def y_speed(self) -> FloatArray:
        """[m/s]."""
        return np.asarray(self.speed * np.sin(self.heading))


@dataclass(frozen=True, slots=True, kw_only=True)
class Traffic:
    """Everybody near a crossing, egos included."""

    persons: PersonsTruth
    vehicles: VehiclesTruth
    acceleration: FloatArray
    """Of the vehicles, shape (n,) [m/s^2]."""
    speed_limit: FloatArray
    """Of the vehicles: the lane's and their own [m/s]."""
    vehicle_class: tuple[str, ...]
    is_ego: tuple[bool, ...]
    """Which of the vehicles are egos now."""


@dataclass(frozen=True, slots=True)
class Mishaps:
    """Faults between a simulator and egos since the start that were mended or given up."""

    routes_restored: int = 0
    """How often an ego had another route than its own, and was given it back."""
    off_the_way: int = 0
    """Steps in which an ego was so far off its way that the simulator has it elsewhere."""
    given_up: tuple[str, ...] = ()
    """Egos handed back to the simulator's driver, because they had left their way for good."""
    not_taken: tuple[str, ...] = ()
    """Cars of a share that could not be taken over: nobody can drive their route."""
    detours: tuple[str, ...] = ()
    """Egos that had missed their lane and took another way to their destination, once for each time."""
    others_teleported: int = 0
    """How often the simulator put another vehicle, which had stood for too long, elsewhere."""
    tight_bends: Mapping[str, float] = field(default_factory=dict)
    """Lanes that bend more than an ego on them can, and how far it gets from them there at least [m]."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The world's truth at one instant; what the judge sees, whatever the egos could sense."""

    time: float
    egos: tuple[EgoTruth, ...]
    persons: PersonsTruth
    vehicles: VehiclesTruth
    teleports: int = 0
    """Egos teleported by SUMO since the start."""
    sensed: tuple[Sensed, ...] | None = None
    """What egos knew at the beginning of the step, if they planned; ``None`` where they know the truth."""
    mishaps: Mishaps = Mishaps()
    traffic: Traffic | None = None
    """``None`` where egos alone are looked at."""


@dataclass(frozen=True, slots=True)
class CrossingFacts:
    """Facts of a crossing that a ranking of crossings needs."""

    lanes: int
    """Lanes for cars that it crosses."""
    speed_limit: float
    """The highest of theirs [m/s]; nan without any."""
    refuge: bool
    """Whether it ends on an island between lanes."""
    longitude: float = math.nan
    """Of its middle [degrees]; nan without a projection."""
    latitude: float = math.nan


@dataclass(frozen=True, slots=True)
class MapArea:
    """One lane, crossing or walking area, for drawing and for judging where an encounter took place."""

    name: str
    kind: str
    """``lane``, ``crossing`` or ``walkingarea``."""
    width: float
    """[m]; 0 for a polygon."""
    shape: FloatArray
    """(n, 2) centre line, or outline for a walking area [m]."""
    crossing_kind: str = ""
    """``CrossingKind`` value for a crossing."""
    facts: CrossingFacts | None = None
    """Of a crossing, where they are known."""
    crossed: tuple[str, ...] = ()
    """Edges that lead over or under it."""
    on_foot: bool = False
    """Whether a lane is one for pedestrians."""


class World(Protocol):
    """Something egos can drive in, one step at a time."""

    step: float
    """Length of a step [s]."""

    def sense(self) -> Sequence[Perception] | None:
        """Return one perception for each ego that is to plan now; ``None`` when the run is over.

        Planning is asked for once per step, but at most every 0.1 s of simulated time: in between the
        sequence is empty and the last commands go on.
        """
        ...

    def act(self, name: str, command: Command) -> None:
        """Set what the ego tries to do from now on."""
        ...

    def advance(self) -> None:
        """Move everything by one step."""
        ...

    def snapshot(self) -> Snapshot:
        """Return the truth after the last step."""
        ...

    def to_world(self, name: str, along: FloatArray, across: FloatArray) -> FloatArray:
        """Convert points of that ego's route frame, as last sensed, to world coordinates, shape (n, 2)."""
        ...

    def map_areas(self) -> Sequence[MapArea]:
        """Return lanes, crossings and walking areas near where the egos have been."""
        ...

    def close(self) -> None:
        """Release the simulation."""
        ...
