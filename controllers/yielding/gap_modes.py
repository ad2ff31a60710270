"""A hybrid controller with four modes, for pedestrians who step onto the road when they accept a gap."""

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
"""Up to this speed, a pedestrian counts as standing [m/s]."""
SAMPLES = 200
"""Number of samples of a braking profile [-]."""


class Mode(StrEnum):
    """What the controller does."""

    NOMINAL = "nominal"
    """Nobody is stepping out: the driver drives."""
    YIELD = "yield"
    """The ego comes to a comfortable stop before the pedestrian."""
    PASS = "pass"
    """No braking could stop the ego before the pedestrian's way: it gets past them."""
    HARD_BRAKE = "hard_brake"
    """The ego can stop only by braking harder than is comfortable."""


@dataclass(frozen=True, slots=True)
class GapRule:
    """When each mode is taken, and how the ego drives in it.

    Parameters
    ----------
    comfortable, hardest : comfortable and greatest deceleration [m/s^2]
    jerk : jerk of comfortable braking [m/s^3]
    acceleration : greatest acceleration in mode pass [m/s^2]
    gain : gain with which a speed is tracked [1/s]
    walking_speed : least speed that pedestrians on their way are assumed to have [m/s]
    advantage : the ego drives on if it arrives earlier than the pedestrian by more than this [s]
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
    The modes, their conditions and control laws are those of [Kapania2019]_, taken from the code that its
    authors published. The paper treats one pedestrian at one crossing. Our own additions: the nearest of
    several pedestrians counts; the ego brakes for pedestrians whom it would meet, and does not pass them; and
    as a filter, the method only limits what the driver wants.
    """

    def __init__(self, rule: GapRule) -> None:
        self._rule = rule
        self._mode = Mode.NOMINAL
        self._yields_to = ""
        self._from = (0.0, 0.0)
        """Speed and distance at the beginning of hard braking [m/s, m]."""

    def allowed(self, facing: Facing) -> Answer:
        """Return what the mode allows; the answer's status names the mode."""
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
        """Return who is in the path, or on their way into it and not there long after the ego, shape (n,)."""
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

        The mode yield goes on for the same pedestrian even if it needs more than comfortable braking; for
        another pedestrian the choice is made anew.
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
    """Speed and acceleration over the distance left to the stop."""

    distance: FloatArray
    """Distances left, ascending [m]."""
    speed: FloatArray
    acceleration: FloatArray

    def at(self, distance: float) -> tuple[float, float]:
        """Return speed and acceleration at a distance; before braking begins, the acceleration is 0."""
        speed = np.interp(distance, self.distance, self.speed)
        return float(speed), float(np.interp(distance, self.distance, self.acceleration))


@lru_cache(maxsize=64)
def comfortable_stop(speed: float, braking: float, jerk: float) -> StopProfile:
    """Return the profile of a trapezoidal deceleration to standstill, limited by ``braking`` and ``jerk``.

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
