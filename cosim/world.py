"""The seam between the step and what it drives: SUMO, or a road without SUMO."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Body, Command, Perception

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class EgoTruth:
    """One ego after a step, as it really is: the plant's state, and what SUMO made of it."""

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
    intervention: bool
    """SUMO's position or speed differs from the plant's by more than 0.02 m or 0.1 m/s."""
    handed_back: bool
    intervention_cause: str = ""
    """One of ``analysis.recording.INTERVENTIONS``; empty without an intervention."""


@dataclass(frozen=True, slots=True)
class PersonsTruth:
    """All pedestrians near any ego; arrays of length n. Riders of vehicles are not among them."""

    names: tuple[str, ...]
    x: FloatArray
    """Centre of the disc [m]."""
    y: FloatArray
    x_speed: FloatArray
    y_speed: FloatArray
    radius: FloatArray
    edge: tuple[str, ...]
    """Edge walked on."""
    crossing: tuple[str, ...]
    """Crossing walked on, or next edge when that is a crossing; else empty."""
    phase: tuple[str, ...]
    """``PedestrianPhase`` values."""
    kind: tuple[str, ...]
    """SUMO type id."""


@dataclass(frozen=True, slots=True)
class VehiclesTruth:
    """All other vehicles near any ego; arrays of length n."""

    names: tuple[str, ...]
    x: FloatArray
    """Centre of the front bumper [m]."""
    y: FloatArray
    heading: FloatArray
    speed: FloatArray
    length: FloatArray
    width: FloatArray
    lane: tuple[str, ...]
    kind: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Sensed:
    """What one ego knew of the pedestrians near it when it planned last; arrays of length n."""

    time: float
    ego: str
    names: tuple[str, ...]
    told: NDArray[np.bool_]
    """Whether the controller was told of this pedestrian."""
    state: tuple[str, ...]
    """State of the measurement: ``cosim.sensing.interface.State`` in lower case."""
    age: FloatArray
    """Age of the measurement in use; nan if not told [s]."""
    error: FloatArray
    """Distance between estimated and true position; nan if not told [m]."""
    uncertainty: FloatArray
    """Estimated standard deviation of the position along either axis; nan if not told [m]."""


@dataclass(frozen=True, slots=True)
class Mishaps:
    """What went wrong between a simulator and egos since the start, and was mended or given up."""

    routes_restored: int = 0
    """How often an ego had another route than its own, and was given it back."""
    off_the_way: int = 0
    """Steps in which an ego was so far off its way that the simulator has it elsewhere."""
    given_up: tuple[str, ...] = ()
    """Egos handed back to the simulator's driver, because they had left their way for good."""
    not_taken: tuple[str, ...] = ()
    """Cars of a share that could not be taken over: nobody can drive their route."""
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
