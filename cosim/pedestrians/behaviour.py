"""The state of a scripted pedestrian, the scene they see, and the interface of a behaviour."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from cosim.arrays import FloatArray

RADIUS = 0.25
"""Radius of a pedestrian's disc [m]."""
STANDING = 0.1
"""Below this speed, a vehicle counts as standing [m/s]."""
BESIDE = 3.0
"""Points this near to the middle axis or the tail of a body are beside or behind it, not on its way [m]."""
SHORTEST = 1e-9
"""Shorter parts of a walk are rounding errors and are dropped [s]."""

Way = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Maps points (n, 2) to positions along and across (left positive) a way, from the front bumper [m]."""


@dataclass(frozen=True, slots=True)
class RoadUser:
    """The true state of a vehicle."""

    name: str
    x: float
    """Centre of the front bumper [m]."""
    y: float
    heading: float
    speed: float
    length: float = 4.5
    width: float = 1.8
    way: Way | None = None
    """Where the vehicle will drive; ``None`` for straight on."""

    def sees(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return positions of points (n, 2) along and across the vehicle's way, from its front bumper [m].

        For points beside and right behind the body, the body's own axes are used instead, as the body may
        be at an angle to its way.

        >>> RoadUser("ego", 10.0, 0.0, 0.0, 5.0).sees(np.array([[30.0, 2.0]]))
        (array([20.]), array([2.]))
        """
        east, north = math.cos(self.heading), math.sin(self.heading)
        dx, dy = points[:, 0] - self.x, points[:, 1] - self.y
        ahead, aside = dx * east + dy * north, dy * east - dx * north
        if self.way is None:
            return ahead, aside
        along, across = self.way(points)
        beside = (ahead < 0.0) & (ahead > -self.length - BESIDE) & (np.abs(aside) < BESIDE)
        return np.where(beside, ahead, along), np.where(beside, aside, across)

    def ahead(self, x: float, y: float) -> tuple[float, float]:
        """Return the position of one point along and across the way, from the front bumper [m]."""
        along, across = self.sees(np.array([[x, y]]))
        return float(along[0]), float(across[0])


@dataclass(frozen=True, slots=True)
class Scene:
    """What pedestrians see of the world at one instant."""

    time: float
    egos: Sequence[RoadUser] = ()
    others: Sequence[RoadUser] = ()
    """Vehicles other than egos."""
    green: Mapping[str, bool] = field(default_factory=dict)
    """Whether the signal of a crossing shows green to pedestrians, by crossing."""

    @property
    def vehicles(self) -> list[RoadUser]:
        """All vehicles."""
        return [*self.egos, *self.others]

    def ego(self, name: str) -> Sequence[RoadUser]:
        """Return the ego of that name if it is present; all egos if the name is empty."""
        return [one for one in self.egos if not name or one.name == name]


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of a walk along a line, with constant acceleration from an initial speed."""

    duration: float
    speed: float
    """Speed at the beginning; negative when walking back [m/s]."""
    acceleration: float = 0.0

    def after(self, elapsed: float) -> tuple[float, float]:
        """Return distance walked [m] and speed [m/s] after a time within the leg."""
        return self.speed * elapsed + 0.5 * self.acceleration * elapsed**2, (
            self.speed + self.acceleration * elapsed
        )

    @property
    def length(self) -> float:
        """Distance walked over the whole leg; negative when walking back [m]."""
        return self.after(self.duration)[0]


@dataclass(frozen=True, slots=True)
class State:
    """One pedestrian at one instant; behaviours keep nothing else between steps."""

    x: float
    y: float
    x_speed: float = 0.0
    y_speed: float = 0.0
    started: float | None = None
    """Time of the start; ``None`` while waiting for it [s]."""
    legs: tuple[Leg, ...] = ()
    """The walk from the start on, as currently planned."""
    ended: float | None = None
    """Time of arrival at the end of the path [s]."""

    @property
    def motion(self) -> tuple[float, float, float, float]:
        """Place and velocity [m, m/s]."""
        return self.x, self.y, self.x_speed, self.y_speed


class Behaviour(Protocol):
    """The behaviour of one pedestrian: a pure function of their state, the time and the scene."""

    def first(self, scene: Scene) -> State | None:
        """Return the state when the pedestrian appears; ``None`` before that."""
        ...

    def next(self, state: State, scene: Scene, until: float) -> State | None:
        """Return the state at the time ``until``; ``None`` after the pedestrian has disappeared.

        Parameters
        ----------
        state : state at ``scene.time``
        scene : what the pedestrian sees then
        until : end of the step [s]
        """
        ...

    def onward(self, state: State, time: float) -> FloatArray:
        """Return the places along the next metres of the planned walk, (n, 2) [m]."""
        ...


def travelled(legs: Sequence[Leg], elapsed: float) -> tuple[float, float]:
    """Return distance [m] and speed [m/s] of a walk after a time; the walker stands at its end.

    >>> travelled((Leg(2.0, 0.0, 0.5), Leg(10.0, 1.0)), 3.0)
    (2.0, 1.0)
    """
    way = 0.0
    for leg in legs:
        if elapsed < leg.duration:
            more, speed = leg.after(max(elapsed, 0.0))
            return way + more, speed
        way += leg.length
        elapsed -= leg.duration
    return way, 0.0


def duration_of(legs: Sequence[Leg]) -> float:
    """Return how long a walk takes [s]."""
    return sum(leg.duration for leg in legs)


def reached(legs: Sequence[Leg], way: float) -> float:
    """Return after what time a walk first reaches a distance ``way``; inf if it never does [s].

    >>> reached((Leg(2.0, 0.0, 0.5), Leg(10.0, 1.0)), 2.0)
    3.0
    """
    gone = elapsed = 0.0
    for leg in legs:
        missing = way - gone
        if missing <= 0.0:
            return elapsed
        if leg.length >= missing - 1e-12:
            root = math.sqrt(leg.speed**2 + 2.0 * leg.acceleration * missing)
            # 2 s / (v + sqrt(v² + 2 a s)) holds for a = 0 too.
            return elapsed + 2.0 * missing / (leg.speed + root)
        gone += leg.length
        elapsed += leg.duration
    return elapsed if way <= gone + 1e-12 else math.inf


def begun(legs: Sequence[Leg], elapsed: float) -> tuple[Leg, ...]:
    """Return the part of a walk before a time.

    >>> begun((Leg(2.0, 1.0), Leg(3.0, 2.0)), 4.0)
    (Leg(duration=2.0, speed=1.0, acceleration=0.0), Leg(duration=2.0, speed=2.0, acceleration=0.0))
    """
    part: list[Leg] = []
    for leg in legs:
        if elapsed <= 0.0:
            break
        part.append(Leg(min(leg.duration, elapsed), leg.speed, leg.acceleration))
        elapsed -= leg.duration
    return tuple(part)


def remaining(legs: Sequence[Leg], elapsed: float) -> tuple[Leg, ...]:
    """Return the part of a walk after a time.

    >>> remaining((Leg(2.0, 1.0), Leg(3.0, 2.0)), 4.0)
    (Leg(duration=1.0, speed=2.0, acceleration=0.0),)
    """
    part: list[Leg] = []
    for leg in legs:
        gone = min(max(elapsed, 0.0), leg.duration)
        if gone < leg.duration:
            part.append(Leg(leg.duration - gone, leg.after(gone)[1], leg.acceleration))
        elapsed -= leg.duration
    return tuple(part)


def paused(legs: Sequence[Leg], elapsed: float, duration: float) -> tuple[Leg, ...]:
    """Return a walk with a pause at a given time; a pause that ends just then is prolonged instead.

    A pedestrian who waits for a gap pauses again at every step. With a new leg for each pause, the list of
    legs would grow and every step would take longer to compute.

    >>> paused((Leg(2.0, 1.0), Leg(0.5, 0.0)), 2.5, 0.5)
    (Leg(duration=2.0, speed=1.0, acceleration=0.0), Leg(duration=1.0, speed=0.0, acceleration=0.0))
    """
    before = [leg for leg in begun(legs, elapsed) if leg.duration > SHORTEST]
    after = [leg for leg in remaining(legs, elapsed) if leg.duration > SHORTEST]
    if before and before[-1].speed == before[-1].acceleration == 0.0:
        duration += before.pop().duration
    return (*before, Leg(duration, 0.0), *after)
