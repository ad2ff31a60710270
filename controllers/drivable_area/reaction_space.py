"""The reaction space: all places that a car can reach while it brakes or steers at the limit of its tyres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.safety.emergency_braking import GRAVITY


def arc_radius(speed: FloatArray, friction: float) -> FloatArray:
    """Return R = v² / (f g) [m]."""
    return np.asarray(speed**2 / (friction * GRAVITY))


def arc_side(forward: FloatArray, radius: FloatArray, width: float) -> FloatArray:
    """Return B / 2 + R − √(R² − x²), the distance of the arc to the side at x [m]."""
    inside = np.clip(forward, 0.0, radius)
    return np.asarray(0.5 * width + radius - np.sqrt(np.maximum(radius**2 - inside**2, 0.0)))


def space_area(reach: FloatArray, radius: FloatArray, width: float) -> FloatArray:
    """Return the area between the arcs from 0 to x [m^2].

    It is B x + 2 R x − x √(R² − x²) − R² asin(x / R).
    """
    safe = np.where(radius > 0.0, radius, 1.0)
    root = np.sqrt(np.maximum(radius**2 - reach**2, 0.0))
    return np.asarray(
        width * reach + 2.0 * radius * reach - reach * root - radius**2 * np.arcsin(reach / safe)
    )


@dataclass(frozen=True, slots=True)
class ReactionSpace:
    """The area between the two tightest arcs at constant speed, as long as the car's stopping distance.

    R = v0² / (f g); ω = f g / v0; x(t) = R sin ωt; y(t) = ±(B / 2 + R (1 − cos ωt)).

    Parameters
    ----------
    speed : v0 [m/s]
    width : B of the car [m]
    friction : f between tyre and road
    resistance : a_r, deceleration by drag, rolling and slope [m/s^2]

    Notes
    -----
    Eqs. (1)-(3) of [Wu2023]_. The printed angle f g / v0 lacks the time, and its sine and cosine are swapped
    because they belong to the other order of axes. The printed Eq. (3) integrates an acceleration once, which
    gives a speed.
    """

    speed: float
    width: float = 1.8
    friction: float = 0.8
    resistance: float = 0.0

    @property
    def radius(self) -> float:
        """Return R [m].

        >>> round(ReactionSpace(40 / 3.6).radius, 1)
        15.7
        """
        return float(arc_radius(np.asarray(self.speed), self.friction))

    @property
    def stopping_time(self) -> float:
        """Return v0 / (f g + a_r) [s]."""
        return self.speed / (self.friction * GRAVITY + self.resistance)

    @property
    def reach(self) -> float:
        """Return the stopping distance x_r [m]."""
        return self.reach_at(self.stopping_time)

    def reach_at(self, time: float) -> float:
        """Return x_r(t) = v0 t − (f g + a_r) t² / 2, constant after the stopping time [m]."""
        time = min(time, self.stopping_time)
        return self.speed * time - 0.5 * (self.friction * GRAVITY + self.resistance) * time**2

    def limit(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the left arc at given times: x forward and y to the left [m]."""
        if self.radius == 0.0:
            return np.zeros(len(times)), np.full(len(times), 0.5 * self.width)
        angle = times * self.speed / self.radius
        return self.radius * np.sin(angle), 0.5 * self.width + self.radius * (1.0 - np.cos(angle))

    def half_width(self, forward: FloatArray) -> FloatArray:
        """Return the distance of the arc to the side at x; see :func:`arc_side` [m]."""
        return arc_side(forward, np.asarray(self.radius), self.width)

    @property
    def area(self) -> float:
        """Return S_z; see :func:`space_area` [m^2].

        >>> round(ReactionSpace(50 / 3.6).area, 1)
        48.4
        """
        return float(space_area(np.asarray(self.reach), np.asarray(self.radius), self.width))

    def contains(self, forward: FloatArray, left: FloatArray) -> NDArray[np.bool_]:
        """Say which points, seen from the middle of the front bumper, are in the space."""
        return (forward >= 0.0) & (forward <= self.reach) & (np.abs(left) <= self.half_width(forward))

    def outline(self, count: int = 20) -> FloatArray:
        """Return the border from the right front corner of the car to the left one, shape (2 n, 2) [m]."""
        forward = np.linspace(0.0, self.reach, count)
        side = self.half_width(forward)
        return np.concatenate((np.column_stack((forward, -side)), np.column_stack((forward, side))[::-1]))
