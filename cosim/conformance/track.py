"""Prescribed motion of an ego in closed form, in place of a plant."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple


class Pose(NamedTuple):
    """Front bumper [m], heading [rad], speed [m/s]."""

    x: float
    y: float
    heading: float
    speed: float


@dataclass(frozen=True, slots=True)
class Shift:
    """A smooth lateral movement; a positive offset is to the left."""

    start: float
    """[s]"""
    duration: float
    """[s]"""
    offset: float
    """[m]"""

    def at(self, time: float) -> tuple[float, float]:
        """Return the lateral offset reached at that time [m] and its rate [m/s].

        The offset is ``offset`` · (10 u³ − 15 u⁴ + 6 u⁵), where u is the elapsed share of the duration.
        """
        u = min(1.0, max(0.0, (time - self.start) / self.duration))
        done = u * u * u * (10.0 + u * (6.0 * u - 15.0))
        rate = 30.0 * u * u * (u - 1.0) * (u - 1.0) / self.duration
        return self.offset * done, self.offset * rate


@dataclass(frozen=True, slots=True)
class Track:
    """Eastward motion with lateral shifts, at constant speed until the vehicle brakes to a stop, if ever."""

    x: float
    y: float
    speed: float
    shifts: tuple[Shift, ...] = ()
    brakes_at: float = math.inf
    """[s]"""
    deceleration: float = 3.0
    """[m/s^2]"""

    def at(self, time: float) -> Pose:
        """Return the pose at that time [s]."""
        braking = max(0.0, min(time - self.brakes_at, self.speed / self.deceleration))
        rolling = min(time, self.brakes_at)
        along = self.speed * (rolling + braking) - 0.5 * self.deceleration * braking * braking
        speed = self.speed - self.deceleration * braking
        across = sum(shift.at(time)[0] for shift in self.shifts)
        rate = sum(shift.at(time)[1] for shift in self.shifts)
        heading = math.atan2(rate, speed) if speed > 0.1 else 0.0
        return Pose(self.x + along, self.y + across, heading, speed)
