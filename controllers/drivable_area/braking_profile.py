"""Speed of a candidate over time: braking with a trapezoidal deceleration, and a smooth cubic substitute."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class TrapezoidalBraking:
    """Braking in four phases: dead time, linear ramp, full braking to v_s, constant speed.

    Parameters
    ----------
    speed, final_speed : v0 and v_s <= v0 [m/s]
    deceleration : a_bmax [m/s^2]
    dead_time, ramp : t_bc, t_cd [s]

    Notes
    -----
    Eqs. (17)-(30) of [Wu2023]_; the driver's reaction time t_ab is 0 here. The printed Eq. (20) lacks the
    minus before the integral, Eq. (24) has t_bc instead of t_cd, and Eq. (29) has other signs of the
    distances. If the speed reaches v_s during the ramp, the ramp ends there; the paper does not treat that
    case.
    """

    speed: float
    final_speed: float
    deceleration: float
    dead_time: float = 0.1
    ramp: float = 0.2

    @property
    def ramp_time(self) -> float:
        """Return for how long the deceleration grows, at most t_cd [s]."""
        if self.ramp == 0.0:
            return 0.0
        lost = self.speed - self.final_speed
        return min(self.ramp, math.sqrt(2.0 * max(lost, 0.0) * self.ramp / self.deceleration))

    @property
    def full_time(self) -> float:
        """Return t_de = (v0 − a t_cd / 2 − v_s) / a, the duration of full braking [s]."""
        lost = self.speed - self.final_speed - 0.5 * self.deceleration * self.ramp
        return max(lost, 0.0) / self.deceleration

    @property
    def ends(self) -> float:
        """Return t_bc + t_cd + t_de, the time after which the speed is v_s [s]."""
        return self.dead_time + self.ramp_time + self.full_time

    @property
    def distance(self) -> float:
        """Return X_bc + X_cd + X_de, the distance after which the speed is v_s [m]."""
        return float(self.position(np.array([self.ends]))[0])

    def cruise_time(self, distance: float) -> float:
        """Return t_ef = (x − X_bc − X_cd − X_de) / v_s, the time from the end of braking to a place [s].

        It is negative if the car passes the place before braking ends, and infinite for v_s = 0 and a place
        beyond the stop.
        """
        left = distance - self.distance
        if self.final_speed > 0.0:
            return left / self.final_speed
        return math.inf if left > 0.0 else 0.0

    def arrival(self, distance: float) -> float:
        """Return t_tcz = t_bc + t_cd + t_de + t_ef, the time of arrival at a place; inf if never [s]."""
        if distance >= self.distance:
            return self.ends + self.cruise_time(distance)
        times = np.linspace(0.0, self.ends, 2001)
        return float(np.interp(distance, self.position(times), times))

    def velocity(self, times: FloatArray) -> FloatArray:
        """Return v(t) [m/s]."""
        ramped, full, _ = self._phases(times)
        slope = self.deceleration / self.ramp if self.ramp > 0.0 else 0.0
        lost = 0.5 * slope * ramped**2 + self.deceleration * full
        return np.asarray(self.speed - np.minimum(lost, self.speed - self.final_speed))

    def position(self, times: FloatArray) -> FloatArray:
        """Return the distances driven by given times [m]."""
        ramped, full, cruise = self._phases(times)
        slope = self.deceleration / self.ramp if self.ramp > 0.0 else 0.0
        before = np.minimum(times, self.dead_time)
        after_ramp = self.speed - 0.5 * slope * ramped**2
        return np.asarray(
            self.speed * (before + ramped)
            - slope * ramped**3 / 6.0
            + after_ramp * full
            - 0.5 * self.deceleration * full**2
            + self.final_speed * cruise
        )

    def _phases(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return how long ramp, full braking and constant speed have lasted by given times [s]."""
        ramped = np.clip(times - self.dead_time, 0.0, self.ramp_time)
        full = np.clip(times - self.dead_time - self.ramp_time, 0.0, self.full_time)
        return ramped, full, np.maximum(times - self.ends, 0.0)


ARRIVALS = 201
"""Number of points of a braking manoeuvre between which the time of arrival is interpolated."""


@dataclass(frozen=True, slots=True)
class SmoothBraking:
    """Speeds v = v0 + a t + b t² + c t³ up to t_s and v_s from then on; all fields have shape (n,).

    Notes
    -----
    Eqs. (31)-(35) of [Wu2023]_ with the acceleration 0 at t_s: a = a0,
    b = (3 (v_s − v0) − 2 a0 t_s) / t_s², c = (−2 (v_s − v0) + a0 t_s) / t_s³. For t_s = 0, the speed is v_s
    from the beginning.
    """

    speed: FloatArray
    final_speed: FloatArray
    acceleration: FloatArray
    """a0 [m/s^2]"""
    duration: FloatArray
    """t_s [s]"""

    @property
    def distance(self) -> FloatArray:
        """Return the distance driven up to t_s: (v0 + v_s) t_s / 2 + a0 t_s² / 12 [m]."""
        mean = 0.5 * (self.speed + self.final_speed)
        return np.asarray(mean * self.duration + self.acceleration * self.duration**2 / 12.0)

    def arrival(self, distance: float) -> FloatArray:
        """Return the times at which a place is reached, shape (n,); inf if never [s].

        The time is t_s + (x − X_s) / v_s if the speed has become v_s before the place. Otherwise it is the
        inverse of the distance over time.

        Notes
        -----
        This is t_tcz of Eqs. (29) and (30) of [Wu2023]_ for the smoothed speed of Eqs. (31)-(35): X_s and t_s
        stand for the distance and the duration of dead time, ramp and braking together.
        """
        left = distance - self.distance
        slowest = np.where(self.final_speed > 0.0, self.final_speed, 1.0)
        late = np.where(self.final_speed > 0.0, self.duration + left / slowest, np.inf)
        shares = np.linspace(0.0, 1.0, ARRIVALS)
        times = self.duration[:, None] * shares
        position, _, _ = self.at(times)
        early = [np.interp(distance, *each) for each in zip(position, times, strict=True)]
        return np.asarray(np.where(left > 0.0, late, early))

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return position, speed and acceleration, shape (n, K) [m, m/s, m/s^2]."""
        lasts = self.duration[:, None]
        t = np.minimum(times, lasts)
        # A change within a microsecond is treated as a step, because its coefficients would overflow.
        safe = np.where(lasts > 1e-6, lasts, 1.0)
        change = (self.final_speed - self.speed)[:, None]
        a = self.acceleration[:, None]
        b = (3.0 * change - 2.0 * a * lasts) / safe**2
        c = (-2.0 * change + a * lasts) / safe**3
        start, end = self.speed[:, None], self.final_speed[:, None]
        after = times >= lasts
        position = t * (start + t * (a / 2.0 + t * (b / 3.0 + t * c / 4.0)))
        velocity = np.where(after, end, start + t * (a + t * (b + t * c)))
        rate = np.where(after, 0.0, a + t * (2.0 * b + t * 3.0 * c))
        return position + end * np.maximum(times - lasts, 0.0), velocity, rate


def shortest_duration(
    speed: float | FloatArray, final_speed: FloatArray, acceleration: float, limit: float
) -> FloatArray:
    """Return the shortest t_s of a cubic speed that never brakes harder than a limit [s].

    It is 3 (v0 − v_s) / (A − a0 + √(A (A + a0))), which is 1.5 (v0 − v_s) / A for a0 = 0.

    Parameters
    ----------
    speed, final_speed : v0 and v_s <= v0 [m/s]
    acceleration : a0, not below −A [m/s^2]
    limit : A [m/s^2]

    Notes
    -----
    The acceleration is the parabola (1 − s) (a0 + q s) with s = t / t_s and q = 6 (v_s − v0) / t_s − 3 a0.
    Its minimum −(q + a0)² / (4 |q|) is −A here.

    >>> float(shortest_duration(10.0, np.array([4.0]), 0.0, 9.0)[0])
    1.0
    """
    begin = max(acceleration, -limit)
    steepest = (limit - begin + math.sqrt(limit * (limit + begin))) / 3.0
    return np.maximum(speed - final_speed, 0.0) / steepest


def longest_duration(speed: float | FloatArray, final_speed: FloatArray, acceleration: float) -> FloatArray:
    """Return the longest t_s for which the speed does not fall below v_s on the way; inf for no limit [s].

    It is 3 (v0 − v_s) / |a0| if the car brakes already.
    """
    lost = np.maximum(speed - final_speed, 0.0)
    if acceleration > -1e-6:
        return np.full(np.shape(lost), np.inf)
    return np.asarray(3.0 * lost / -acceleration)
