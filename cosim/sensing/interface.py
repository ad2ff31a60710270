"""Inputs and outputs of a sensing model.

A model stands between the world's truth and one ego's perception. It is told where all road users really are,
and returns which pedestrians the ego knows of and where it believes them to be. Positions and velocities are
in world coordinates [m, m/s]. Only the world queries a model; the judge of a run looks at the truth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

from controllers.interface import Body
from cosim.arrays import BoolArray, FloatArray, IntArray

FARTHEST_UNIT = 50.0
"""A unit further than this from every lane is outside the network [m]."""


class State(IntEnum):
    """Detection of one pedestrian at one instant; with several sensors, the smallest value counts."""

    VISIBLE = 0
    """Measured, and the ego has the newest measurement."""
    LATE = 1
    """Measured; the message is on its way."""
    LOST = 2
    """Measured; the message with it was lost."""
    MISSED = 3
    """In view, but not detected."""
    HIDDEN = 4
    """Within range and field of view, but behind something."""
    OUT_OF_RANGE = 5
    """Beyond the range, or outside the field of view."""


@dataclass(frozen=True, slots=True)
class Site:
    """The parts of a scene that do not move."""

    crossings: Mapping[str, FloatArray]
    """By name: (n, 2) middle line from kerb to kerb [m]."""
    lanes: FloatArray
    """(n, 4) straight pieces of all lanes: x, y of the beginning, then of the end [m].

    If it is empty, units may be anywhere.
    """
    walls: FloatArray
    """(n, 4) sides of everything that stands beside the road, with values in the same order [m]."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The truth around one ego at one instant."""

    ego: str
    time: float
    tick: int
    """Number of the simulation's step."""
    x: float
    """Centre of the ego's rear axle [m]."""
    y: float
    heading: float
    body: Body
    names: tuple[str, ...]
    """Pedestrians near the ego; the next three arrays have a row for each."""
    position: FloatArray
    velocity: FloatArray
    radius: FloatArray
    front: FloatArray
    """(m, 2) front bumpers of other vehicles near the ego [m]; the next three arrays belong to them."""
    vehicle_heading: FloatArray
    length: FloatArray
    width: FloatArray
    interval: float = 0.1
    """Time between two looks of any ego [s]."""


@dataclass(frozen=True, slots=True)
class Belief:
    """An ego's knowledge of the pedestrians of a scene: one row each, also for those it does not know."""

    told: BoolArray
    """Whether the controller is told of this pedestrian."""
    position: FloatArray
    """Estimated position [m]; nan where it is not told."""
    velocity: FloatArray
    uncertainty: FloatArray
    """Standard deviation of the position along either axis [m]; nan where it is not told."""
    age: FloatArray
    """Time since the last measurement on which the position is based [s]; nan where it is not told."""
    state: IntArray
    """``State`` values."""


@dataclass(frozen=True, slots=True)
class Sensed:
    """One ego's knowledge of the pedestrians near it at its last plan; arrays of length n."""

    time: float
    ego: str
    names: tuple[str, ...]
    told: BoolArray
    """Whether the controller was told of this pedestrian."""
    state: tuple[str, ...]
    """State of the measurement: `State` in lower case."""
    age: FloatArray
    """Age of the measurement in use; nan if not told [s]."""
    error: FloatArray
    """Distance between estimated and true position; nan if not told [m]."""
    uncertainty: FloatArray
    """Estimated standard deviation of the position along either axis; nan if not told [m]."""


class Sensor(Protocol):
    """The sensor of one ego during one run; it remembers past measurements."""

    def look(self, scene: Scene) -> Belief:
        """Return what the ego knows now; to be called with increasing time."""
        ...


class Sensing(Protocol):
    """A sensing model with its parameters."""

    @property
    def exact(self) -> bool:
        """Whether egos know the truth, so that no sensor is needed."""
        ...

    def sensor(self, site: Site, seed: int, ego: str) -> Sensor:
        """Return a new sensor.

        Parameters
        ----------
        site : what does not move
        seed : seed of the run; draws depend on it and on names, not on what the ego does
        ego : name of the ego

        Raises
        ------
        ValueError
            If the parameters do not fit the site.
        """
        ...
