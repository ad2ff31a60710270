"""A lane change along a polynomial of degree seven whose first three derivatives vanish at both ends.

``across(s) = width (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7)`` with ``s`` = along / length from 0 to 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.lane_keeping import Place

PROFILE = np.polynomial.Polynomial([0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0])
"""Profile from 0 to 1; its first three derivatives vanish at both ends."""
_SLOPE, _BEND = PROFILE.deriv(1), PROFILE.deriv(2)
STEEPEST = 35.0 / 16.0
"""Largest slope of the profile, at its middle."""
SHARPEST = 84.0 / 5.0**1.5
"""Largest second derivative of the profile, at s = 1/2 − sqrt(5)/10."""


@dataclass(frozen=True, slots=True)
class SepticPath:
    """One lane change.

    Parameters
    ----------
    width : offset after the change, positive to the left [m]
    length : [m]

    Notes
    -----
    This is the reference without avoidance of [VOMPC2019]_, which prints no coefficients. No other
    polynomial of degree seven has these ends.

    >>> path = SepticPath(3.5, 30.0)
    >>> [path.at(along).across for along in (0.0, 15.0, 30.0)]
    [0.0, 1.75, 3.5]
    """

    width: float
    length: float

    def at(self, along: float) -> Place:
        """Return offset, slope and bend; the path is straight before and after the change."""
        share = min(max(along / self.length, 0.0), 1.0)
        return Place(
            self.width * float(PROFILE(share)),
            self.width / self.length * float(_SLOPE(share)),
            self.width / self.length**2 * float(_BEND(share)),
        )

    def across(self, along: FloatArray) -> FloatArray:
        """Return the offsets at along coordinates, same shape [m]."""
        return np.asarray(self.width * PROFILE(np.clip(along / self.length, 0.0, 1.0)))

    def steepest(self) -> float:
        """Return the largest angle to the lane [rad]."""
        return float(np.arctan(abs(self.width) / self.length * STEEPEST))

    def lateral_speed(self, speed: float) -> float:
        """Return the largest speed across at a constant speed along [m/s]."""
        return abs(self.width) / self.length * STEEPEST * speed

    def lateral_acceleration(self, speed: float) -> float:
        """Return the largest acceleration across at a constant speed along [m/s^2]."""
        return abs(self.width) / self.length**2 * SHARPEST * speed**2
