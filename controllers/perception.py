"""What a controller is told: the ego, the road ahead of it, and the other road users.

All values are SI; angles are radians, counter-clockwise from east. The *route frame* has its origin at
the ego's rear axle, projected on the centre line of the lane the ego is in (the *reference lane*,
followed along the route): ``along`` is arc length forward of it, ``across`` is the distance from the
centre line, left positive. Absent values are ``None``; arrays hold finite numbers only, except where a
field says that infinity means "not within range".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Body:
    """Dimensions of a vehicle [m]."""

    length: float = 4.5
    width: float = 1.8
    wheelbase: float = 2.6
    rear_overhang: float = 0.95
    """Distance from the rear axle to the rear bumper [m]."""

    @property
    def front(self) -> float:
        """Distance from the rear axle to the front bumper [m]."""
        return self.length - self.rear_overhang


@dataclass(frozen=True, slots=True)
class Drive:
    """What the actuators can do: first-order lags [s] and limits [m/s^2, m/s^3, rad, rad/s]."""

    drive_lag: float
    steering_lag: float
    max_acceleration: float
    max_deceleration: float
    max_steering: float
    max_steering_rate: float


@dataclass(frozen=True, slots=True)
class EgoState:
    """The state of the ego according to its own sensors."""

    name: str
    time: float
    """Simulated time [s]."""
    x: float
    """World position of the rear axle [m]."""
    y: float
    heading: float
    """World heading [rad]."""
    across: float
    """Offset of the rear axle from the reference lane's centre line, left positive [m]."""
    heading_error: float
    """Heading relative to the centre line at the rear axle [rad]."""
    speed: float
    acceleration: float
    """Realised acceleration, after the drive lag [m/s^2]."""
    steering: float
    """Realised front-wheel angle, left positive [rad]."""
    body: Body
    drive: Drive
    plan_interval: float
    """Time until the next plan is requested [s]."""


class PedestrianPhase(StrEnum):
    """What a pedestrian is about to do."""

    CROSSING = "crossing"
    """The pedestrian is on a crossing."""
    WAITING = "waiting"
    """The pedestrian is not on a crossing yet, but the next edge of their walk is one."""
    WALKING = "walking"
    """The pedestrian is anywhere else."""


@dataclass(frozen=True, slots=True)
class Pedestrians:
    """Pedestrians in the route frame; arrays of length n.

    Pedestrians on, or about to enter, a crossing of ``RoadAhead.crossings`` are given in the straight frame
    tangent to the reference lane where it meets that crossing, so that a turning path distorts neither their
    distance nor their velocity.
    """

    names: tuple[str, ...]
    along: FloatArray
    across: FloatArray
    along_speed: FloatArray
    across_speed: FloatArray
    radius: FloatArray
    crossing: IntArray
    """Index into ``RoadAhead.crossings`` of the crossing walked on or next, −1 for none."""
    on_crossing: NDArray[np.bool_]
    """True for those on the crossing itself (phase CROSSING)."""
    waiting: NDArray[np.bool_]
    """True for those whose next edge is that crossing (phase WAITING)."""
    uncertainty: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Standard deviation of the position along either axis [m]; zeros if not given: the truth is known."""
    position: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    """Positions in the world, (n, 2) [m]; nan if not given: only the places along the route are known."""
    velocity: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    """Velocities in the world, (n, 2) [m/s]; nan if not given."""

    def __post_init__(self) -> None:
        """Fill in what is not given."""
        if not len(self.uncertainty) and self.names:
            object.__setattr__(self, "uncertainty", np.zeros(len(self.names)))
        for name in ("position", "velocity"):
            if not len(getattr(self, name)) and self.names:
                object.__setattr__(self, name, np.full((len(self.names), 2), np.nan))

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True, slots=True)
class Vehicles:
    """Other vehicles in the route frame; arrays of length n, any lane and any direction."""

    names: tuple[str, ...]
    along: FloatArray
    """Along coordinate of the front bumper's centre [m]."""
    across: FloatArray
    """Across coordinate of the body's centre [m]."""
    along_speed: FloatArray
    across_speed: FloatArray
    acceleration: FloatArray
    heading_error: FloatArray
    """Heading relative to the centre line, in (−pi, pi] [rad]."""
    length: FloatArray
    width: FloatArray
    position: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    """Positions of the front bumpers' centres in the world, (n, 2) [m]; nan if not given."""
    heading: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Headings in the world [rad]; nan if not given."""

    def __post_init__(self) -> None:
        """Fill in what is not given."""
        if not len(self.heading) and self.names:
            object.__setattr__(self, "position", np.full((len(self.names), 2), np.nan))
            object.__setattr__(self, "heading", np.full(len(self.names), np.nan))

    def __len__(self) -> int:
        return len(self.names)


Many = TypeVar("Many", Pedestrians, Vehicles)


def only(many: Many, chosen: Sequence[int] | IntArray) -> Many:
    """Return the pedestrians or vehicles with the given indices."""
    arrays = {one.name: getattr(many, one.name)[chosen] for one in fields(many) if one.name != "names"}
    return replace(many, names=tuple(many.names[i] for i in chosen), **arrays)


_NONE = np.zeros(0)
NOBODY = Pedestrians(
    (), _NONE, _NONE, _NONE, _NONE, _NONE, np.zeros(0, np.int64), np.zeros(0, np.bool_), np.zeros(0, np.bool_)
)
"""No pedestrians."""


@dataclass(frozen=True, slots=True)
class Neighbour:
    """The next vehicle ahead of or behind the ego in one lane."""

    name: str
    gap: float
    """True distance between bumpers; negative while the bodies overlap along the lane [m]."""
    speed: float
    acceleration: float
    length: float


@dataclass(frozen=True, slots=True)
class NeighbourGaps:
    """Neighbours in the ego's lane and the adjacent ones; ``None`` if there is none within range."""

    ahead: Neighbour | None = None
    behind: Neighbour | None = None
    left_ahead: Neighbour | None = None
    left_behind: Neighbour | None = None
    right_ahead: Neighbour | None = None
    right_behind: Neighbour | None = None


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane of the ego's own direction, usable by it, beside or under the ego."""

    number: int
    """Lane coordinate: 0 where the trip began, +1 for each lane further left."""
    offset: float
    """Across coordinate of its centre line at the ego [m]."""
    width: float
    follows_route_for: float
    """Distance ahead of the rear axle up to which the lane leads along the route; inf if it does so as far as
    the view reaches [m]."""


class CrossingKind(StrEnum):
    """Who has to wait at a crossing."""

    ZEBRA = "zebra"
    """Pedestrians have priority, or priority is not regulated and they wait for nobody."""
    UNMARKED = "unmarked"
    """Vehicles have priority."""
    SIGNAL = "signal"
    """Signals decide."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """A pedestrian crossing over the reference lane."""

    name: str
    kind: CrossingKind
    entry: float
    """Along coordinate where the crossing's area begins [m]."""
    exit: float
    stop_line: float
    """Along coordinate where a front bumper should stop to leave the crossing free [m]."""
    right: float
    """Across coordinate of the crossing's right end (kerb), along its axis [m]."""
    left: float
    """Across coordinate of the crossing's left end (kerb), along its axis [m]."""
    pedestrians_have_green: bool | None
    """``None`` where no signal controls it."""

    @property
    def gives_priority(self) -> bool:
        """Whether pedestrians may go first: on a zebra, or at green."""
        return self.kind is CrossingKind.ZEBRA or bool(self.pedestrians_have_green)

    def begins(self, across: float) -> float:
        """Return where the crossing begins for a pedestrian: across coordinate of the nearer end [m]."""
        return self.right if 2.0 * across < self.right + self.left else self.left


class SignalState(StrEnum):
    """A traffic light as the ego sees it."""

    RED = "red"
    AMBER = "amber"
    GREEN = "green"
    """Green, including permissive green; ``RoadAhead.foes`` says to whom the ego has to yield."""


@dataclass(frozen=True, slots=True)
class Signal:
    """A stop line with a traffic light."""

    name: str
    stop_line: float
    state: SignalState


@dataclass(frozen=True, slots=True)
class StopSign:
    """A stop line with a stop sign: vehicles have to stop there, even if they need not yield to anybody."""

    name: str
    stop_line: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class JunctionFoe:
    """A vehicle whose path crosses that of the ego inside a junction ahead."""

    name: str
    entry: float
    """Along coordinate where the ego's path enters the conflict [m]."""
    exit: float
    stop_line: float
    """Along coordinate of the ego's stop line before that junction [m]."""
    foe_entry: float
    """Distance from the foe's front bumper to the conflict; negative once past its beginning [m]."""
    foe_exit: float
    """Distance that the foe has to drive until its rear bumper has left the conflict [m]."""
    foe_speed: float
    must_yield: bool
    waiting_place: float | None = None
    """Where vehicles wait inside the junction for the foe; ``None`` without such a place [m]."""


@dataclass(frozen=True, slots=True)
class RoadAhead:
    """The road along the route, from the ego's rear axle on."""

    lanes: tuple[Lane, ...]
    """Right to left; contains the reference lane and at most the two beside it."""
    reference: int
    """``Lane.number`` of the reference lane."""
    right_edge: float
    """Across coordinate of the right end of the lanes the ego may use [m]."""
    left_edge: float
    curvature: FloatArray
    """Curvature of the reference lane at multiples of ``curvature_step``, from the rear axle on [1/m]."""
    curvature_step: float
    limit_along: FloatArray
    """Along coordinates from which the speed limits apply, ascending, first one <= 0 [m]."""
    limit: FloatArray
    """Speed limits [m/s]."""
    crossings: tuple[Crossing, ...] = ()
    """Ascending by entry; includes those the ego is on."""
    signals: tuple[Signal, ...] = ()
    stop_signs: tuple[StopSign, ...] = ()
    foes: tuple[JunctionFoe, ...] = ()
    route_end: float = float("inf")
    """Along coordinate of the route's end; inf beyond the view [m]."""

    def lane(self, number: int) -> Lane | None:
        """Return the lane with that coordinate, or ``None``."""
        for lane in self.lanes:
            if lane.number == number:
                return lane
        return None


@dataclass(frozen=True, slots=True)
class Eyesight:
    """Where the ego's sensor for pedestrians is; the ego may not be told of pedestrians hidden from it."""

    ahead: float
    """Distance from the rear axle to the sensor, along the body [m]."""
    left: float
    """Distance from the body's centre line to the sensor, left positive [m]."""
    watched: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    """Areas that others watch for the ego, (k, 3): x and y of the middle in the world, radius [m]."""


@dataclass(frozen=True, slots=True)
class Perception:
    """Everything a controller may know at one instant."""

    ego: EgoState
    pedestrians: Pedestrians
    vehicles: Vehicles
    gaps: NeighbourGaps
    road: RoadAhead
    eyesight: Eyesight | None = None
    """Place of the ego's sensor; ``None`` if the ego is told of everybody."""
