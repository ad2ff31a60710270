"""The state of a scripted pedestrian, the scene they see, and the interface of a behaviour."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from cosim.arrays import FloatArray

RADIUS = 0.25
"""Of a pedestrian's disc [m]."""
STANDING = 0.1
"""Slower vehicles stand [m/s]."""
BESIDE = 3.0
"""Places this near to the middle of a body or to its tail are beside or behind it, and not on its way [m]."""
SHORTEST = 1e-9
"""A shorter part of a walk is what rounding left of it [s]."""

Way = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Places (n, 2) -> along and across (left positive) from a vehicle's front bumper, along its way [m]."""


@dataclass(frozen=True, slots=True)
class RoadUser:
    """A vehicle as it really is."""

    name: str
    x: float
    """Centre of the front bumper [m]."""
    y: float
    heading: float
    speed: float
    length: float = 4.5
    width: float = 1.8
    way: Way | None = None
    """Where it will drive; ``None``: straight on."""

    def sees(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return along and across of places (n, 2), from the front bumper [m].

        Beside and right behind the body they are told from the body: it may stand askew on its way.

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
        """Return along and across of one place, from the front bumper [m]."""
        along, across = self.sees(np.array([[x, y]]))
        return float(along[0]), float(across[0])


@dataclass(frozen=True, slots=True)
class Scene:
    """The world at one instant, as far as pedestrians look at it."""

    time: float
    egos: Sequence[RoadUser] = ()
    others: Sequence[RoadUser] = ()
    """Vehicles that are no egos."""
    green: Mapping[str, bool] = field(default_factory=dict)
    """By crossing with a signal: whether it shows green to pedestrians."""

    @property
    def vehicles(self) -> list[RoadUser]:
        """All vehicles."""
        return [*self.egos, *self.others]

    def ego(self, name: str) -> Sequence[RoadUser]:
        """Return the ego of that name if it is there; all egos for the empty name."""
        return [one for one in self.egos if not name or one.name == name]


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of a walk along a line: constant acceleration, from a speed on, for a time."""

    duration: float
    speed: float
    """At its beginning; negative walks back [m/s]."""
    acceleration: float = 0.0

    def after(self, elapsed: float) -> tuple[float, float]:
        """Return way [m] and speed [m/s] after a part of the leg."""
        return self.speed * elapsed + 0.5 * self.acceleration * elapsed**2, (
            self.speed + self.acceleration * elapsed
        )

    @property
    def length(self) -> float:
        """Way to its end; negative backwards [m]."""
        return self.after(self.duration)[0]


@dataclass(frozen=True, slots=True)
class State:
    """One pedestrian at one instant; all that a behaviour remembers."""

    x: float
    y: float
    x_speed: float = 0.0
    y_speed: float = 0.0
    started: float | None = None
    """Time of the start; ``None`` while waiting for it [s]."""
    legs: tuple[Leg, ...] = ()
    """The walk from then on, as presently planned."""
    ended: float | None = None
    """Time of arrival at the end of the path [s]."""

    @property
    def motion(self) -> tuple[float, float, float, float]:
        """Place and velocity [m, m/s]."""
        return self.x, self.y, self.x_speed, self.y_speed


class Behaviour(Protocol):
    """The behaviour of one pedestrian: a pure function of their state, the time and the scene."""

    def first(self, scene: Scene) -> State | None:
        """Return the state at the appearance; ``None`` before it."""
        ...

    def next(self, state: State, scene: Scene, until: float) -> State | None:
        """Return the state at the time ``until``; ``None`` after the pedestrian has disappeared.

        Parameters
        ----------
        state : at ``scene.time``
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
    """Return when a walk has come a way forward for the first time; inf if it never does [s].

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
    """Return a walk that pauses at a time; one that stands then already stands for longer.

    Whoever waits for a gap pauses again at every step: with a leg for each, every step would take longer.

    >>> paused((Leg(2.0, 1.0), Leg(0.5, 0.0)), 2.5, 0.5)
    (Leg(duration=2.0, speed=1.0, acceleration=0.0), Leg(duration=1.0, speed=0.0, acceleration=0.0))
    """
    before = [leg for leg in begun(legs, elapsed) if leg.duration > SHORTEST]
    after = [leg for leg in remaining(legs, elapsed) if leg.duration > SHORTEST]
    if before and before[-1].speed == before[-1].acceleration == 0.0:
        duration += before.pop().duration
    return (*before, Leg(duration, 0.0), *after)
