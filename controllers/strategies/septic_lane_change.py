"""Changes lanes along a polynomial of degree seven and does not react to pedestrians at all: the reference.

Across: lane keeping; lane changes that route and traffic require, or one at the start, follow a septic path
instead of the one of the lane keeping. Along: what leaders, signals, right of way, bends and limits require.
It yields to no pedestrian, not even at a zebra, and has no emergency brake: it is the comparison without
avoidance of the velocity-obstacle paper.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.lanes.gap_acceptance import blocker
from controllers.driving.lanes.lane_path import LanePath, Odometer, told
from controllers.driving.lanes.septic_path import SepticPath
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import (
    Command,
    Controller,
    Decision,
    Lane,
    Manoeuvre,
    Perception,
    Plan,
)
from controllers.settings import ControllerSettings, NotNegative, Positive

SHORTEST = 8.0
"""Least length of a lane change, however slow the ego is [m]."""
SHOWN = 40
"""Number of points of the path in a plan."""
AT_THE_START = "start"


class StartChange(StrEnum):
    """A lane change to begin with."""

    NONE = "none"
    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, slots=True)
class Beside:
    """A septic path as an offset from the lane that it leads to."""

    path: SepticPath

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return self.path.length

    def at(self, along: float) -> lane_keeping.Place:
        """Return the place ``along`` metres after the beginning."""
        place = self.path.at(along)
        return lane_keeping.Place(place.across - self.path.width, place.slope, place.bend)


class SepticLaneChange:
    """Drives one ego.

    Parameters
    ----------
    style : driving style of the traffic driver
    duration : duration of a change at the speed at which it begins [s]
    length : length of a change, whatever the speed [m]; ``None``: duration times speed
    start : whether and where to change lanes as soon as there is room
    after : distance to drive before that [m]
    """

    def __init__(
        self,
        style: DrivingStyle,
        duration: float,
        length: float | None,
        start: StartChange,
        after: float,
    ) -> None:
        self._traffic = TrafficDriver(style)
        self._duration, self._length = duration, length
        self._start, self._after = start, after
        self._odometer = Odometer()
        self._path: LanePath | None = None
        self._target: int | None = None

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in; begin a path if that is another one."""
        travelled = self._odometer.look(perception.ego)
        decision = self._traffic.decide(perception)
        if self._start is not StartChange.NONE and travelled >= self._after:
            decision = self._at_the_start(perception, decision)
        lane = perception.road.lane(decision.target_lane)
        if self._target is None:
            self._target = perception.road.reference
        if lane is not None and decision.target_lane != self._target:
            # A change that is given up leads back by lane keeping: there is no time for another curve.
            given_up = decision.manoeuvre is Manoeuvre.ABORT_CHANGE
            self._path = None if given_up else self._begun(perception, lane, travelled)
        self._target = decision.target_lane
        return decision

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive as traffic requires, along the path while there is one."""
        times = lane_keeping.instants(perception.ego)
        acceleration = self._traffic.accelerations(perception, decision)
        travelled = self._odometer.travelled
        if self._path is not None and self._path.left(travelled) < 0.0:
            self._path = None
        course = self._path.seen(perception, travelled) if self._path is not None else None
        if self._path is None or course is None:
            return Plan(
                Command(times, acceleration, self._traffic.steering(perception, decision, acceleration))
            )
        angles = lane_keeping.steering(perception, course, acceleration)
        along = np.linspace(0.0, self._path.left(travelled), SHOWN)
        speed = max(perception.ego.speed, 0.1)
        return Plan(
            Command(times, acceleration, angles),
            times=along / speed,
            along=along,
            across=told(course, along),
            speed=np.full(SHOWN, perception.ego.speed),
        )

    def _at_the_start(self, perception: Perception, decision: Decision) -> Decision:
        """Begin the change requested for the start, once, as soon as nobody is in the way."""
        road = perception.road
        if decision.manoeuvre is not Manoeuvre.KEEP or decision.target_lane != road.reference:
            return decision
        number = road.reference + (1 if self._start is StartChange.LEFT else -1)
        if road.lane(number) is None or blocker(perception, number) is not None:
            return decision
        left, self._start = self._start is StartChange.LEFT, StartChange.NONE
        self._traffic.change_to(perception, number, AT_THE_START)
        manoeuvre = Manoeuvre.CHANGE_LEFT if left else Manoeuvre.CHANGE_RIGHT
        return Decision(manoeuvre, number, because=AT_THE_START)

    def _begun(self, perception: Perception, lane: Lane, travelled: float) -> LanePath:
        ego = perception.ego
        length = self._length if self._length is not None else self._duration * max(ego.speed, 0.0)
        path = SepticPath(lane.offset - ego.across, max(length, SHORTEST))
        return LanePath(lane.number, travelled, Beside(path))


class Settings(ControllerSettings):
    """The parameters of the controller."""

    duration_s: Positive = 4.0
    """Duration of a lane change, at the speed at which it begins."""
    length_m: Positive | None = None
    """Length of a lane change, whatever the speed; none: duration times speed."""
    start_change: StartChange = StartChange.NONE
    """Change to the lane on that side once, as soon as there is room."""
    start_after_m: NotNegative = 0.0
    """Distance to drive before that change."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    return SepticLaneChange(
        DrivingStyle(headway=settings.headway_s),
        settings.duration_s,
        settings.length_m,
        settings.start_change,
        settings.start_after_m,
    )
