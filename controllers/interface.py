"""The interface of a controller: what it is told, from :mod:`controllers.perception`, and what it answers.

Values are in SI units and in the frames of the perception. All names are to be imported from here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np

from controllers.arrays import FloatArray, IntArray
from controllers.own_part import OwnPart
from controllers.perception import (
    Body,
    Crossing,
    CrossingKind,
    Drive,
    EgoState,
    Eyesight,
    JunctionFoe,
    Lane,
    Neighbour,
    NeighbourGaps,
    PedestrianPhase,
    Pedestrians,
    Perception,
    RoadAhead,
    Signal,
    SignalState,
    StopSign,
    Vehicles,
)

__all__ = [
    "HAND_BACK",
    "Body",
    "Command",
    "Controller",
    "Crossing",
    "CrossingKind",
    "Decision",
    "Drive",
    "EgoState",
    "Eyesight",
    "FloatArray",
    "IntArray",
    "JunctionFoe",
    "Lane",
    "Manoeuvre",
    "Neighbour",
    "NeighbourGaps",
    "PedestrianPhase",
    "Pedestrians",
    "Perception",
    "Plan",
    "RoadAhead",
    "Signal",
    "SignalState",
    "Solves",
    "StopSign",
    "Vehicles",
    "constant_command",
]


class Manoeuvre(StrEnum):
    """What the controller wants to do."""

    KEEP = "keep"
    CHANGE_LEFT = "change_left"
    CHANGE_RIGHT = "change_right"
    ABORT_CHANGE = "abort_change"
    HAND_BACK = "hand_back"
    """The controller lets SUMO's own driver drive."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What the controller wants, and the reason."""

    manoeuvre: Manoeuvre
    target_lane: int
    """``Lane.number`` to end in."""
    rule: str | None = None
    """The rule by which the method decided, in its own words; ``None`` if it has no rules."""
    because: str = ""
    """Name of the vehicle, pedestrian, signal or lane end that mattered most; empty for none."""


@dataclass(frozen=True, slots=True)
class Command:
    """Desired acceleration and front-wheel angle from now on; the last entry is held.

    A world applies ``acceleration[i]`` from ``times[i]`` until ``times[i + 1]``.
    """

    times: FloatArray
    acceleration: FloatArray
    steering: FloatArray
    hand_back: bool = False
    """Whether SUMO's own driver drives until the next command; the other fields are then not used."""


def constant_command(acceleration: float, steering: float) -> Command:
    """Return the command that holds an acceleration [m/s^2] and a front-wheel angle [rad]."""
    return Command(np.zeros(1), np.array([acceleration]), np.array([steering]))


HAND_BACK = Command(np.zeros(1), np.zeros(1), np.zeros(1), hand_back=True)


@dataclass(frozen=True, slots=True)
class Solves:
    """The quadratic programs of one control step."""

    solver: str
    """Which solver ran."""
    programs: int
    unsolved: int
    """Number of programs without a solution whose certificate holds."""


@dataclass(frozen=True, slots=True)
class Plan:
    """How the decision is carried out. A plan always exists; ``solved`` says whether it is the wanted one."""

    command: Command
    solved: bool = True
    status: str = "ok"
    """``ok``, or the name of the fallback that was used instead."""
    passing: str = ""
    """Passing class by names, for instance ``behind=p1|p2 ahead=p3``; empty with nobody in conflict."""
    slack: float = 0.0
    """Largest violation of a soft constraint [m]."""
    solves: Solves | None = None
    """The programs solved for this plan; ``None`` if there were none."""
    own: OwnPart | None = None
    """The method's own part of the plan; ``None`` for a controller that has no method for pedestrians."""
    times: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Horizon [s from now]; the next three fields have its length and describe the rear axle in the route
    frame."""
    along: FloatArray = field(default_factory=lambda: np.zeros(0))
    across: FloatArray = field(default_factory=lambda: np.zeros(0))
    speed: FloatArray = field(default_factory=lambda: np.zeros(0))
    overlay: Mapping[str, FloatArray] = field(default_factory=dict)
    """Shapes that a replay may draw, by name: cones, fields, candidates."""

    @property
    def states_own(self) -> bool:
        """Whether ``own`` is given."""
        return self.own is not None


class Controller(Protocol):
    """Drives one ego for one run."""

    def decide(self, perception: Perception) -> Decision:
        """Return what to do."""
        ...

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return how to do it."""
        ...
