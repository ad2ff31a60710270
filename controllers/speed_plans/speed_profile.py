"""Speed over time in pieces of constant acceleration, or of constant jerk for comfort.

Everything is plain floating-point arithmetic on closed forms: position and speed are exact at any time, and
a profile is made in microseconds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray

INSTANT = 1e-9
"""A window shorter than this smooths nothing: the slopes of its ramps could be infinite [s]."""


@dataclass(frozen=True, slots=True)
class Segment:
    """One piece of a profile."""

    duration: float
    """[s]"""
    acceleration: float
    """Acceleration at its beginning [m/s^2]."""
    jerk: float = 0.0
    """[m/s^3]"""


@dataclass(frozen=True, slots=True)
class SpeedProfile:
    """A speed plan from now on; after its last piece, the speed stays constant."""

    speed: float
    """Speed at the beginning [m/s]."""
    segments: tuple[Segment, ...] = ()

    @property
    def duration(self) -> float:
        """Return the duration of all pieces together [s]."""
        return math.fsum(one.duration for one in self.segments)

    @property
    def final_speed(self) -> float:
        """Return the speed after the last piece [m/s]."""
        return self.knots()[-1][2]

    def knots(self) -> list[tuple[float, float, float]]:
        """Return time, distance and speed at the beginning and after every piece [s, m, m/s]."""
        time, distance, speed = 0.0, 0.0, self.speed
        found = [(time, distance, speed)]
        for one in self.segments:
            distance += _distance(speed, one, one.duration)
            speed = max(_speed(speed, one, one.duration), 0.0)
            time += one.duration
            found.append((time, distance, speed))
        return found

    def at(self, time: float) -> tuple[float, float, float]:
        """Return distance, speed and acceleration at a time; before the beginning, those at the beginning.

        Between two pieces, the acceleration is that of the second.

        >>> SpeedProfile(2.0, (Segment(4.0, -0.5),)).at(2.0)
        (3.0, 1.0, -0.5)
        """
        return self._after(time, self.knots())

    def sampled(self, times: Iterable[float]) -> FloatArray:
        """Return distance, speed and acceleration at many times, shape (3, N)."""
        knots = self.knots()
        return np.array([self._after(float(time), knots) for time in times]).reshape(-1, 3).T

    def _after(self, time: float, knots: list[tuple[float, float, float]]) -> tuple[float, float, float]:
        """Return what ``at`` does, from the knots of the profile."""
        time = max(time, 0.0)
        for one, (_, distance, speed) in zip(self.segments, knots, strict=False):
            if time < one.duration:
                return (
                    distance + _distance(speed, one, time),
                    max(_speed(speed, one, time), 0.0),
                    one.acceleration + one.jerk * time,
                )
            time -= one.duration
        _, distance, speed = knots[-1]
        return distance + speed * time, speed, 0.0

    def breaks(self, begin: float) -> list[float]:
        """Return when pieces end after ``begin``, relative to it [s]."""
        return [time - begin for time, _, _ in self.knots() if time > begin]

    def mean_accelerations(self, begin: float, times: FloatArray, end: float) -> FloatArray:
        """Return the mean acceleration from each time to the next, which gives exact speeds at those times.

        Parameters
        ----------
        begin : time at which the first interval begins, on the profile's own clock [s]
        times : beginnings of the intervals relative to ``begin``, ascending from 0 [s]
        end : end of the last interval, relative to ``begin`` [s]
        """
        edges = np.append(times, end)
        return np.asarray(np.diff(self.sampled(begin + edges)[1]) / np.diff(edges))

    def time_at(self, distance: float) -> float:
        """Return the time at which a distance has been covered; inf for never [s].

        >>> SpeedProfile(0.0, (Segment(2.0, 1.0),)).time_at(6.0)
        4.0
        """
        if distance <= 0.0:
            return 0.0
        time, covered, speed = 0.0, 0.0, self.speed
        for one in self.segments:
            piece = _distance(speed, one, one.duration)
            if covered + piece >= distance:
                return time + _when(speed, one, distance - covered)
            covered += piece
            speed = max(_speed(speed, one, one.duration), 0.0)
            time += one.duration
        return time + (distance - covered) / speed if speed > 1e-9 else math.inf

    def rest(self, begin: float) -> SpeedProfile:
        """Return the rest of the profile from a time on."""
        left = []
        passed = max(begin, 0.0)
        for one in self.segments:
            if passed >= one.duration:
                passed -= one.duration
                continue
            left.append(Segment(one.duration - passed, one.acceleration + one.jerk * passed, one.jerk))
            passed = 0.0
        return SpeedProfile(self.at(begin)[1], tuple(left))

    def least_gap(self, gap: float, speed: float) -> float:
        """Return the smallest gap to something ahead that keeps its speed [m].

        Parameters
        ----------
        gap : present gap [m]
        speed : speed of what is ahead [m/s]
        """
        least, time, distance, mine = gap, 0.0, 0.0, self.speed
        for one in self.segments:
            for moment in _equal_speed(mine, one, speed):
                there = gap + speed * (time + moment) - distance - _distance(mine, one, moment)
                least = min(least, there)
            distance += _distance(mine, one, one.duration)
            mine = max(_speed(mine, one, one.duration), 0.0)
            time += one.duration
            least = min(least, gap + speed * time - distance)
        return least if mine <= speed + 1e-9 else -math.inf


def smoothed(profile: SpeedProfile, window: float, before: float = 0.0) -> SpeedProfile:
    """Return the profile whose acceleration is the mean of the given profile's over the window just past.

    a'(t) = (1 / T) ∫ a(τ) dτ from t − T to t, with a constant acceleration before the beginning. Its jerk is
    at most the range of a divided by T. Accelerations and speeds stay within the ranges of the given profile.

    Parameters
    ----------
    profile : profile of pieces without jerk, beginning in the state that :func:`anticipated` gives
    window : T [s]
    before : acceleration before the beginning, with which the result begins [m/s^2]
    """
    if window < INSTANT:
        return profile
    jumps: list[tuple[float, float]] = []
    time, present = 0.0, before
    for one in (*profile.segments, Segment(0.0, 0.0)):
        if one.acceleration != present:
            jumps.append((time, one.acceleration - present))
            present = one.acceleration
        time += one.duration
    # Every jump becomes a ramp as long as the window.
    slopes = [(at, size / window) for at, size in jumps] + [
        (at + window, -size / window) for at, size in jumps
    ]
    pieces: list[Segment] = []
    acceleration, jerk, now = before, 0.0, 0.0
    for at, change in sorted(slopes):
        if at > now:
            pieces.append(Segment(at - now, acceleration, jerk))
            acceleration += jerk * (at - now)
            now = at
        jerk += change
    start = profile.speed - 0.5 * before * window
    return SpeedProfile(max(start, 0.0), tuple(pieces))


def anticipated(speed: float, window: float, before: float) -> tuple[float, float]:
    """Return where a profile has to begin so that its smoothed form begins in the present state.

    Its speed is v + a T / 2, and it is ahead by v T / 2 + a T² / 12: the mean over the window of a motion
    with constant acceleration a that ends there is the present state.

    Parameters
    ----------
    speed : v [m/s]
    window : T [s]
    before : a [m/s^2]

    Returns
    -------
    tuple
        Speed [m/s] and how far ahead [m].

    >>> anticipated(10.0, 1.0, 0.0)
    (10.0, 5.0)
    """
    ahead = 0.5 * speed * window + before * window**2 / 12.0
    return speed + 0.5 * before * window, ahead


def _speed(speed: float, one: Segment, time: float) -> float:
    return speed + (one.acceleration + 0.5 * one.jerk * time) * time


def _distance(speed: float, one: Segment, time: float) -> float:
    # No speed is negative; rounding at a standstill must not lead backwards.
    return max((speed + (0.5 * one.acceleration + one.jerk * time / 6.0) * time) * time, 0.0)


def _equal_speed(speed: float, one: Segment, other: float) -> list[float]:
    """Return the times within a piece at which its speed equals ``other`` [s]."""
    missing = other - speed
    if one.jerk == 0.0:
        roots = [missing / one.acceleration] if one.acceleration != 0.0 else []
    else:
        square = one.acceleration**2 + 2.0 * one.jerk * missing
        root = math.sqrt(max(square, 0.0))
        roots = (
            [(-one.acceleration + sign * root) / one.jerk for sign in (-1.0, 1.0)] if square >= 0.0 else []
        )
    return [time for time in roots if 0.0 < time < one.duration]


def _when(speed: float, one: Segment, distance: float) -> float:
    """Return the time within a piece after which a distance is covered; speeds are not negative [s]."""
    if one.jerk == 0.0:
        end = math.sqrt(max(speed**2 + 2.0 * one.acceleration * distance, 0.0))
        return 2.0 * distance / max(speed + end, 1e-12)
    low, high = 0.0, one.duration
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _distance(speed, one, middle) < distance else (low, middle)
    return high
