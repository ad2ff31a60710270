"""The interface between the step and the world that it drives: SUMO, or a road without SUMO."""

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

    ``analysis/recording/columns.py`` says what of it is recorded, and under which names.
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
    """SUMO's lane id; empty if SUMO has it on no lane."""
    route_position: float
    """Distance travelled since the ego was taken over [m]."""
    speed_limit: float
    commanded_acceleration: float
    commanded_steering: float
    executed_x: float
    """Centre of the front bumper where SUMO has it after the step [m]."""
    executed_y: float
    executed_speed: float
    intervention_cause: str | None = None
    """Why SUMO's position or speed differs from the plant's by more than 0.02 m or 0.1 m/s, one of
    ``INTERVENTIONS`` in ``analysis/recording/columns.py``; ``None`` if it does not."""
    handed_back: bool = False

    @property
    def intervention(self) -> bool:
        """Whether SUMO's vehicle did something other than the plant."""
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
    """Edge that each walks on."""
    crossing: tuple[str | None, ...]
    """Crossing that each walks on, or the next edge if that is a crossing."""
    phase: tuple[str, ...]
    """``PedestrianPhase`` values."""
    kind: tuple[str, ...]
    """SUMO type id."""
    signal: tuple[str | None, ...] | None = None
    """``green`` or ``red``, the light for pedestrians at that crossing; ``None`` where there is no light, or
    instead of all values if lights were not read."""

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
    """Lane that each drives on."""
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
    """All road users near a crossing, egos included."""

    persons: PersonsTruth
    vehicles: VehiclesTruth
    acceleration: FloatArray
    """Acceleration of the vehicles, shape (n,) [m/s^2]."""
    speed_limit: FloatArray
    """Speed limit of the vehicles, from the lane's limit and their own [m/s]."""
    vehicle_class: tuple[str, ...]
    is_ego: tuple[bool, ...]
    """Whether each vehicle is an ego now."""


@dataclass(frozen=True, slots=True)
class Mishaps:
    """Faults in the coupling of a simulator and egos since the start, whether corrected or not."""

    routes_restored: int = 0
    """How often the simulator had another route for an ego than its own, and was given its own again."""
    off_the_way: int = 0
    """Number of steps in which an ego was so far off its way that the simulator had it elsewhere."""
    given_up: tuple[str, ...] = ()
    """Egos handed back to the simulator's driver for good: they had left their way or stood for too long."""
    not_taken: tuple[str, ...] = ()
    """Cars of a share that could not be taken over, because their route cannot be driven."""
    detours: tuple[str, ...] = ()
    """Egos that had missed their lane and took another way to their destination, once for each detour."""
    others_teleported: int = 0
    """How often the simulator teleported another vehicle because it had stood for too long."""
    tight_bends: Mapping[str, float] = field(default_factory=dict)
    """Lanes that bend too tightly for an ego on them, and how far the ego's path leads away from them [m]."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The truth about the world at one instant: what the judge sees, whatever the egos could sense."""

    time: float
    egos: tuple[EgoTruth, ...]
    persons: PersonsTruth
    vehicles: VehiclesTruth
    teleports: int = 0
    """How many egos SUMO has teleported, or removed before they arrived, since the start."""
    sensed: tuple[Sensed, ...] | None = None
    """What egos knew at the beginning of the step, if they planned; ``None`` if they know the truth."""
    mishaps: Mishaps = Mishaps()
    traffic: Traffic | None = None
    """All road users near crossings; ``None`` if only road users near egos are observed."""


@dataclass(frozen=True, slots=True)
class CrossingFacts:
    """Facts of a crossing that a ranking of crossings needs."""

    lanes: int
    """Lanes for cars that it crosses."""
    speed_limit: float
    """Highest speed limit of these lanes [m/s]; nan if there are none."""
    refuge: bool
    """Whether it ends on an island between lanes."""
    longitude: float = math.nan
    """Longitude of its middle [degrees]; nan without a projection."""
    latitude: float = math.nan


@dataclass(frozen=True, slots=True)
class MapArea:
    """One lane, crossing or walking area, for drawing and for judging where an encounter took place."""

    name: str
    kind: str
    """``lane``, ``crossing`` or ``walkingarea``."""
    width: float
    """Width [m]; 0 for a polygon."""
    shape: FloatArray
    """(n, 2) centre line, or outline for a walking area [m]."""
    crossing_kind: str = ""
    """``CrossingKind`` value for a crossing."""
    facts: CrossingFacts | None = None
    """Facts of a crossing, if they are known."""
    crossed: tuple[str, ...] = ()
    """Edges that lead over or under it."""
    on_foot: bool = False
    """Whether only pedestrians may use a lane."""


class World(Protocol):
    """A world in which egos drive, one step at a time."""

    step: float
    """Length of a step [s]."""

    def sense(self) -> Sequence[Perception] | None:
        """Return one perception for each ego that has to plan now; ``None`` when the run is over.

        Plans are requested once per step, but at most every 0.1 s of simulated time. In between, the sequence
        is empty and the last commands stay in force.
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
