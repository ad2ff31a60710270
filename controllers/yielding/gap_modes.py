"""A hybrid controller of four modes for pedestrians who step onto the road when they accept a gap."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.following import limit_now
from controllers.yielding.facing import Answer, Facing

WALKS = 0.2
"""A slower pedestrian stands [m/s]."""
SAMPLES = 200
"""Of a braking's profile."""


class Mode(StrEnum):
    """What the controller does."""

    NOMINAL = "nominal"
    """Nobody is stepping out: the driver drives."""
    YIELD = "yield"
    """Comes to a stop before the pedestrian, comfortably."""
    PASS = "pass"
    """Nothing would stop the ego before the pedestrian's way: it gets past them."""
    HARD_BRAKE = "hard_brake"
    """Only more than comfortable braking stops the ego."""


@dataclass(frozen=True, slots=True)
class GapRule:
    """When which mode is taken, and how it drives.

    Parameters
    ----------
    comfortable, hardest : braking [m/s^2]
    jerk : of comfortable braking [m/s^3]
    acceleration : in mode pass, at most [m/s^2]
    gain : with which a speed is tracked [1/s]
    walking_speed : pedestrians on their way are taken to be as fast at least [m/s]
    advantage : an ego that arrives so much earlier than the pedestrian drives on [s]
    """

    comfortable: float
    hardest: float
    jerk: float
    acceleration: float
    gain: float
    walking_speed: float
    advantage: float


class GapFilter:
    """The modes of one ego.

    Parameters
    ----------
    rule : when which mode is taken

    Notes
    -----
    The modes, their conditions and laws are those of [Kapania2019]_, read in the code that its authors
    published. It treats one pedestrian at one crossing. Ours: of several the nearest counts; whoever would
    be met is braked for and not passed; and as a filter, it only limits what the driver wants.
    """

    def __init__(self, rule: GapRule) -> None:
        self._rule = rule
        self._mode = Mode.NOMINAL
        self._yields_to = ""
        self._from = (0.0, 0.0)
        """Speed and distance at which hard braking began [m/s, m]."""

    def allowed(self, facing: Facing) -> Answer:
        """Return what the mode asks for; the mode is the answer's status."""
        out = np.flatnonzero(self._stepping_out(facing))
        if not len(out):
            self._mode = Mode.NOMINAL
            return Answer()
        speed, rule = max(facing.perception.ego.speed, 0.0), self._rule
        distance = np.maximum(facing.gaps[out], 0.0)
        late = (speed**2 > 2.0 * rule.hardest * distance) & ~facing.meets(0.0)[out]
        if late.all():
            self._mode = Mode.PASS
            name = facing.people.names[int(out[np.argmin(distance)])]
            return Answer(rule.acceleration, True, name, status=_told(self._mode))
        out, distance = out[~late], distance[~late]
        first = int(np.argmin(distance))
        name = facing.people.names[int(out[first])]
        most = self._braking(facing, speed, float(distance[first]), name)
        return Answer(min(most, facing.wanted), True, name, status=_told(self._mode))

    def _stepping_out(self, facing: Facing) -> BoolArray:
        """Return who is on their way into the path, or in it, and not long after the ego, shape (n,)."""
        ego, people, rule = facing.perception.ego, facing.people, self._rule
        pace = np.abs(people.across_speed)
        inside = people.enter <= 0.0
        to_walk = np.abs(people.across - ego.across) - 0.5 * ego.body.width - people.radius
        reaches = np.maximum(to_walk, 0.0) / np.maximum(pace, rule.walking_speed)
        arrives = facing.gaps / max(ego.speed, 0.1)
        near = arrives - reaches >= -rule.advantage
        ahead = people.along + people.radius > 0.0
        return np.asarray(ahead & (inside | ((pace > WALKS) & near)))

    def _braking(self, facing: Facing, speed: float, distance: float, name: str) -> float:
        """Take the mode that stops within a distance, and return its acceleration [m/s^2].

        Yielding to somebody goes on when it needs more than is comfortable; to somebody else it begins anew.
        """
        rule = self._rule
        hard = self._mode is Mode.HARD_BRAKE
        yields = self._mode is Mode.YIELD and self._yields_to == name
        if not hard and (yields or speed**2 <= 2.0 * rule.comfortable * distance):
            self._mode, self._yields_to = Mode.YIELD, name
            limit = limit_now(facing.perception.road, facing.perception.ego.body.front)
            cruising = max(speed, limit) if math.isfinite(limit) else speed
            wanted, planned = comfortable_stop(cruising, rule.comfortable, rule.jerk).at(distance)
            return max(planned + rule.gain * (wanted - speed), -rule.hardest)
        if not hard or distance > self._from[1]:
            self._mode, self._from = Mode.HARD_BRAKE, (speed, max(distance, 1e-3))
        began, way = self._from
        needed = speed**2 / (2.0 * max(distance, 0.1))
        wanted = began * math.sqrt(distance / way)
        return max(-needed + rule.gain * (wanted - speed), -rule.hardest)


@dataclass(frozen=True, slots=True)
class StopProfile:
    """Speed and acceleration over the distance that is left to the stop."""

    distance: FloatArray
    """Ascending [m]."""
    speed: FloatArray
    acceleration: FloatArray

    def at(self, distance: float) -> tuple[float, float]:
        """Return both at a distance; before braking begins the acceleration is 0."""
        speed = np.interp(distance, self.distance, self.speed)
        return float(speed), float(np.interp(distance, self.distance, self.acceleration))


@lru_cache(maxsize=64)
def comfortable_stop(speed: float, braking: float, jerk: float) -> StopProfile:
    """Return a trapezoidal deceleration to standstill: up and down with the jerk, at most the braking.

    >>> profile = comfortable_stop(12.0, 3.0, 1.5)
    >>> round(float(profile.distance[-1]), 1)  # 12**2 / (2 * 3) + 12 * 3 / (2 * 1.5)
    36.0
    """
    most = min(braking, math.sqrt(jerk * speed))
    ramp = most / jerk
    held = max(speed / most - ramp, 0.0) if most > 0.0 else 0.0
    end = 2.0 * ramp + held
    times = np.sort(np.append(np.linspace(0.0, end, SAMPLES), (ramp, end - ramp)))
    deceleration = np.minimum(np.minimum(times, end - times) * jerk, most)
    step = np.diff(times)
    speeds = speed - np.append(0.0, np.cumsum(0.5 * step * (deceleration[1:] + deceleration[:-1])))
    driven = np.append(0.0, np.cumsum(0.5 * step * (speeds[1:] + speeds[:-1])))
    return StopProfile((driven[-1] - driven)[::-1], np.maximum(speeds, 0.0)[::-1], -deceleration[::-1])


def _told(mode: Mode) -> str:
    return "ok" if mode is Mode.NOMINAL else f"mode_{mode.value}"
