"""A straight road with scripted road users.

The road runs east from x = 0. Lanes are counted from the right (south), and lane 0's centre line is y = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from controllers.interface import Body, CrossingKind, Neighbour, NeighbourGaps, Vehicles
from cosim.arrays import FloatArray
from cosim.sensing.interface import Site
from cosim.step.plant import Plant
from cosim.step.world import MapArea

Motion = Callable[[float], tuple[float, float, float, float]]
"""Time [s] -> x, y, x speed, y speed [m, m/s]."""


@runtime_checkable
class ReactingMotion(Protocol):
    """The motion of a pedestrian who sees the ego. It has a memory: use one per pedestrian and run."""

    def __call__(self, time: float) -> tuple[float, float, float, float]:
        """Return position and velocity at the time of the last `react`, or at the start."""
        ...

    def react(self, time: float, ego: Plant) -> None:
        """Move on to a time, seeing the ego as it is then."""
        ...


def walk(
    x: float, y: float, x_speed: float, y_speed: float, start: float = 0.0, stop: float = np.inf
) -> Motion:
    """Return the motion of a pedestrian who is at (x, y), walks from ``start`` to ``stop``, then stands."""

    def at(time: float) -> tuple[float, float, float, float]:
        walked = min(max(time - start, 0.0), stop - start)
        moving = start <= time < stop
        return (
            x + x_speed * walked,
            y + y_speed * walked,
            x_speed if moving else 0.0,
            y_speed if moving else 0.0,
        )

    return at


@dataclass(frozen=True, slots=True)
class ToyPedestrian:
    """A scripted pedestrian."""

    name: str
    motion: Motion
    radius: float = 0.25


@dataclass(frozen=True, slots=True)
class ToyVehicle:
    """A scripted vehicle; the motion is that of its front bumper."""

    name: str
    motion: Motion
    length: float = 4.5
    width: float = 1.8


@dataclass(frozen=True, slots=True)
class ToyCrossing:
    """A crossing over all lanes, from ``x`` to ``x + width``."""

    x: float
    width: float = 4.0
    kind: CrossingKind = CrossingKind.ZEBRA


@dataclass(frozen=True, slots=True)
class ToyRoad:
    """A straight road."""

    lanes: int = 1
    lane_width: float = 3.5
    speed_limit: float = 13.89
    crossings: tuple[ToyCrossing, ...] = ()

    def centre(self, lane: int) -> float:
        """Return the distance of a lane's centre line from that of lane 0 [m]."""
        return lane * self.lane_width

    def edges(self) -> tuple[float, float]:
        """Return the right and the left edge of the road [m]."""
        half = 0.5 * self.lane_width
        return -half, self.centre(self.lanes - 1) + half

    def crossing_at(self, x: float, y: float) -> int:
        """Return the index of the crossing that a point is on; −1 if there is none."""
        right, left = self.edges()
        for i, c in enumerate(self.crossings):
            if c.x <= x <= c.x + c.width and right <= y <= left:
                return i
        return -1

    def map_areas(self, far: float) -> list[MapArea]:
        """Return the lanes, up to a distance [m], and the crossings."""
        width = self.lane_width
        lanes = [
            MapArea(f"toy_{i}", "lane", width, np.array([[0.0, i * width], [far, i * width]]))
            for i in range(self.lanes)
        ]
        crossings = [
            MapArea(f"toy_c{i}", "crossing", c.width, self._middle_of(c), c.kind.value)
            for i, c in enumerate(self.crossings)
        ]
        return [*lanes, *crossings]

    def site(self) -> Site:
        """Return what sensors need to know of the road."""
        crossings = {f"toy_c{i}": self._middle_of(c) for i, c in enumerate(self.crossings)}
        return Site(crossings, np.zeros((0, 4)), np.zeros((0, 4)))

    def _middle_of(self, crossing: ToyCrossing) -> FloatArray:
        """Return the middle line of a crossing, from edge to edge."""
        right, left = self.edges()
        middle = crossing.x + crossing.width / 2
        return np.array([[middle, right], [middle, left]])


def gaps_among(vehicles: Vehicles, body: Body, lane_width: float) -> NeighbourGaps:
    """Return the nearest vehicles ahead of and behind an ego of that size, in its lane and beside it."""
    lanes = {"": 0.0, "left_": lane_width, "right_": -lane_width}
    found: dict[str, Neighbour | None] = {
        f"{lane}{where}": None for lane in lanes for where in ("ahead", "behind")
    }
    ego_middle = 0.5 * (body.front - body.rear_overhang)
    columns = vehicles.along, vehicles.across, vehicles.along_speed, vehicles.acceleration, vehicles.length
    each = zip(vehicles.names, *(column.tolist() for column in columns), strict=True)
    for name, along, across, speed, acceleration, length in each:
        ahead = along - 0.5 * length >= ego_middle
        gap = along - length - body.front if ahead else -body.rear_overhang - along
        for lane, centre in lanes.items():
            key = f"{lane}{'ahead' if ahead else 'behind'}"
            best = found[key]
            if abs(across - centre) < 0.5 * (lane_width + 1.0) and (best is None or gap < best.gap):
                found[key] = Neighbour(name, gap, speed, acceleration, length)
    return NeighbourGaps(**found)
