"""The start of a pedestrian: at a time, when an ego is near enough, or when the road is clear."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from cosim.pedestrians.behaviour import RADIUS, Leg, RoadUser, Scene, reached
from cosim.pedestrians.line import Line


class Start(Protocol):
    """Decides when a pedestrian sets off."""

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the instant of the start if it comes before ``until``; it may lie between two steps [s]."""
        ...


@dataclass(frozen=True, slots=True)
class AtTime:
    """Start at a given time [s]."""

    time: float

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the time if it comes before ``until`` [s]."""
        return max(self.time, scene.time) if self.time < until else None


@dataclass(frozen=True, slots=True)
class EgoNear:
    """Start when an ego's front bumper is a distance, or a time at its speed, from where it crosses the line.

    If the ego's way does not cross the line, the distance to the beginning of the line counts.

    Parameters
    ----------
    line : the line to walk along
    distance : distance of the front bumper from the line [m]
    arrival : time in which the ego would reach the line at its speed [s]
    ego : name of the ego; empty for any
    """

    line: Line
    distance: float = 0.0
    arrival: float = 0.0
    ego: str = ""

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the instant at which the first ego is that near, if it keeps its speed."""
        instants = [self._of(vehicle, scene.time) for vehicle in scene.ego(self.ego)]
        found = [instant for instant in instants if instant is not None and instant < until]
        return min(found, default=None)

    def _of(self, vehicle: RoadUser, time: float) -> float | None:
        meeting = self.line.meeting(vehicle)
        along = vehicle.ahead(self.line.x, self.line.y)[0] if meeting is None else meeting.along
        if along < 0.0:
            return None
        missing = along - self.distance - self.arrival * vehicle.speed
        if missing <= 0.0:
            return time
        return time + missing / vehicle.speed if vehicle.speed > 0.0 else None


@dataclass(frozen=True, slots=True)
class Impact:
    """Start so that an ego that keeps its speed hits the pedestrian with a given point of its front bumper.

    The pedestrian reaches that point of the ego's width when the front bumper touches their disc:
    t_start = t + (d − r) / v − t_walk, where d is the distance of the front bumper from the line.

    Parameters
    ----------
    line : the line to walk along
    overlap : share of the ego's width, from the side that the pedestrian comes from
    legs : legs of the planned walk
    speed : nominal speed of the ego; ``None`` for its actual speed [m/s]
    ego : name of the ego; empty for any
    """

    line: Line
    overlap: float
    legs: tuple[Leg, ...]
    speed: float | None = None
    ego: str = ""

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the earliest instant of all egos, if it comes before ``until``."""
        found = [self._of(vehicle, scene.time) for vehicle in scene.ego(self.ego)]
        return min((instant for instant in found if instant is not None and instant < until), default=None)

    def _of(self, vehicle: RoadUser, time: float) -> float | None:
        if vehicle.speed <= 0.0:
            return None
        from_left = vehicle.ahead(self.line.x, self.line.y)[1] > 0.0
        offset = (0.5 - self.overlap) * vehicle.width * (1.0 if from_left else -1.0)
        meeting = self.line.meeting(vehicle, offset)
        if meeting is None or meeting.along < 0.0:
            return None
        left = meeting.along - RADIUS
        nominal = vehicle.speed if self.speed is None else self.speed
        walks = reached(self.legs, meeting.middle)
        if math.isinf(walks):
            return None
        return max(time, time + (left - nominal * walks) / vehicle.speed)


@dataclass(frozen=True, slots=True)
class WhenClear:
    """Start at the first acceptable gap after another start.

    See `Meeting.leaves_gap`.

    Parameters
    ----------
    start : the earliest start
    line : the line to walk along
    gap : smallest accepted gap [s]
    speed : expected walking speed [m/s]
    """

    start: Start
    line: Line
    gap: float
    speed: float

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the instant of the other start if the road is clear."""
        instant = self.start.instant(scene, until)
        if instant is None or any(self._blocks(vehicle) for vehicle in scene.vehicles):
            return None
        return instant

    def _blocks(self, vehicle: RoadUser) -> bool:
        meeting = self.line.meeting(vehicle)
        if meeting is None:
            return False
        return not meeting.leaves_gap(vehicle, max(meeting.enters, 0.0) / self.speed, self.gap)


@dataclass(frozen=True, slots=True)
class WhileSignal:
    """Start once another start allows it and a signal shows red, or green; if off, it shows neither."""

    start: Start
    crossing: str
    green: bool

    def instant(self, scene: Scene, until: float) -> float | None:
        """Return the instant of the other start if the signal shows the awaited colour."""
        instant = self.start.instant(scene, until)
        return instant if scene.green.get(self.crossing) is self.green else None
