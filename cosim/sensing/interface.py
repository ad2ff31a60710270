"""Inputs and outputs of a sensing model.

A model stands between the world's truth and one ego's perception. It is told where everybody really is
and answers whom the ego knows of, and where it believes them. Positions and velocities are in world
coordinates [m, m/s]. Nobody but the world asks it; whoever judges a run looks at the truth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

from controllers.interface import Body
from cosim.arrays import BoolArray, FloatArray, IntArray

FARTHEST_UNIT = 50.0
"""A place further than this from every lane is outside the network [m]."""


class State(IntEnum):
    """Detection of one pedestrian at one instant; of several sensors the smallest value counts."""

    VISIBLE = 0
    """Measured, and the ego has the newest measurement."""
    LATE = 1
    """Measured; the message is on its way."""
    LOST = 2
    """Measured; the message with it was lost."""
    MISSED = 3
    """In view, but not detected."""
    HIDDEN = 4
    """Within range and field of view, behind something."""
    OUT_OF_RANGE = 5
    """Beyond the range, or outside the field of view."""


@dataclass(frozen=True, slots=True)
class Site:
    """The parts of a scene that do not move."""

    crossings: Mapping[str, FloatArray]
    """By name: (n, 2) middle line from kerb to kerb."""
    lanes: FloatArray
    """(n, 4) straight pieces of all lanes: x, y of the beginning, then of the end; empty for no limit."""
    walls: FloatArray
    """(n, 4) sides of everything that stands beside the road, in the same order."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The truth around one ego at one instant."""

    ego: str
    time: float
    tick: int
    """Number of the simulation's step."""
    x: float
    """Ego's rear axle."""
    y: float
    heading: float
    body: Body
    names: tuple[str, ...]
    """Pedestrians near the ego; the next three have a row for each."""
    position: FloatArray
    velocity: FloatArray
    radius: FloatArray
    front: FloatArray
    """(m, 2) front bumpers of the other vehicles near the ego; the next three belong to them."""
    vehicle_heading: FloatArray
    length: FloatArray
    width: FloatArray


@dataclass(frozen=True, slots=True)
class Belief:
    """An ego's knowledge of the pedestrians of a scene: a row for each, also for unknown ones."""

    told: BoolArray
    """Whether the controller is told of this one."""
    position: FloatArray
    """nan where it is not told."""
    velocity: FloatArray
    uncertainty: FloatArray
    """Standard deviation of the position along either axis [m]; nan where it is not told."""
    age: FloatArray
    """Time since the last measurement that the position rests on [s]; nan where it is not told."""
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
    """The sensor of one ego during one run; it has a memory."""

    def look(self, scene: Scene) -> Belief:
        """Return what the ego knows now; called with growing time."""
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
        seed : of the run; what is drawn depends on it and on names, not on what the ego does
        ego : name

        Raises
        ------
        ValueError
            For parameters that do not fit the site.
        """
        ...
