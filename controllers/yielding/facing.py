"""What a filter is told: who comes into the ego's path, where it could stop for them, and what it wants."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import Conflicts, find
from controllers.interface import Decision, Perception, Solves

HORIZON = 8.0
"""Pedestrians who come into the way later than this are not considered yet [s]."""
LINE_GAP = 0.3
"""A stop line still counts if the bumper has passed it by less than this [m]."""
SLOWEST = 2.0
"""The ego is assumed to drive at least at this speed, so that there is a time when it meets people [m/s]."""


@dataclass(frozen=True, slots=True)
class Facing:
    """The pedestrians in the ego's path, ordered by time of entry, and what its driver wants to do."""

    perception: Perception
    people: Conflicts
    """The n pedestrians in conflict."""
    places: FloatArray
    """Place where the front bumper would stop to yield to each, from the rear axle, shape (n,) [m]."""
    wanted: float
    """Acceleration that the driver would command [m/s^2]."""

    @property
    def gaps(self) -> FloatArray:
        """Distances from the front bumper to those places, shape (n,) [m]."""
        return self.places - self.perception.ego.body.front

    def meets(self, time_margin: float) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Return whom the ego would meet if it kept its speed, shape (n,).

        It meets those who are in its path while it passes them, or less than ``time_margin`` before or after.
        """
        ego, people = self.perception.ego, self.people
        speed = max(ego.speed, SLOWEST)
        closing = np.maximum(speed - people.along_speed, 0.5)
        arrives = np.maximum(people.along - people.radius - ego.body.front, 0.0) / closing
        leaves = np.maximum(people.along + people.radius + ego.body.rear_overhang, 0.0) / closing
        return np.asarray((people.enter <= leaves + time_margin) & (people.leave >= arrives - time_margin))


@dataclass(frozen=True, slots=True)
class Answer:
    """What a filter allows."""

    most: float = math.inf
    """Greatest acceleration; inf if the driver may do what it wants [m/s^2]."""
    applies: bool = False
    """Whether the condition for the filter to act holds."""
    because: str = ""
    """Name of the pedestrian who is the reason; empty for none."""
    solved: bool = True
    status: str = "ok"
    overridden: bool = False
    """Whether a fallback replaces the method's own answer."""
    passing: str = ""
    slack: float = 0.0
    solves: Solves | None = None
    times: FloatArray | None = None
    """Times of the planned motion; ``None`` if the filter plans none [s]."""
    along: FloatArray | None = None
    """[m]"""
    speed: FloatArray | None = None
    """[m/s]"""


class SpeedFilter(Protocol):
    """Limits the acceleration of one ego because of pedestrians; it may have memory."""

    def allowed(self, facing: Facing) -> Answer:
        """Return what the filter allows until the next plan."""
        ...


class PathWatch:
    """Finds who is in the way; one per ego, because it remembers what people did.

    Parameters
    ----------
    side_margin : margin by which a pedestrian's disc is grown across the way [m]
    standoff : distance kept to a pedestrian, with or without a stop line [m]
    """

    def __init__(self, side_margin: float, standoff: float) -> None:
        self._side_margin, self._standoff = side_margin, standoff
        self._watch, self._assume = Watch(), PedestrianAssumptions()

    def look(self, perception: Perception, decision: Decision, wanted: float) -> Facing:
        """Return who is in the way between the ego's present place and the lane decided for."""
        ego, lane = perception.ego, perception.road.lane(decision.target_lane)
        half, offset = 0.5 * ego.body.width, lane.offset if lane is not None else 0.0
        band = (min(ego.across, offset) - half, max(ego.across, offset) + half)
        people = find(perception, self._watch, band, self._side_margin, HORIZON, self._assume, abreast=False)
        beside = people.along - people.radius - self._standoff
        ahead = people.stop_line > ego.body.front - LINE_GAP
        places = np.where(ahead, np.minimum(people.stop_line, beside), beside)
        return Facing(perception, people, places, wanted)
