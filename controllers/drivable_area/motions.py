"""Motions of candidates: a path across the road, driven at a changing speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.braking_profile import SmoothBraking
from controllers.drivable_area.quintic_path import QuinticPaths, curvature

POINTS = 101
"""Number of points along a path at which its length is summed up."""


@dataclass(frozen=True, slots=True)
class Motions:
    """Motions of n candidates at K times; all arrays but ``times`` have shape (n, K)."""

    times: FloatArray
    """Times from now, ascending, shape (K,) [s]."""
    along: FloatArray
    """x [m]"""
    across: FloatArray
    """y [m]"""
    heading: FloatArray
    """[rad]"""
    curvature: FloatArray
    """[1/m]"""
    speed: FloatArray
    """[m/s]"""
    acceleration: FloatArray
    """[m/s^2]"""


def motions(paths: QuinticPaths, speeds: SmoothBraking, times: FloatArray, dead_time: float = 0.0) -> Motions:
    """Return how n candidates move.

    Parameters
    ----------
    paths, speeds : n of each
    times : shape (K,) [s]
    dead_time : time for which the car keeps its initial speed [s]
    """
    begun = np.maximum(times - dead_time, 0.0)
    driven, speed, acceleration = speeds.at(begun[None, :])
    driven = driven + speeds.speed[:, None] * np.minimum(times, dead_time)
    acceleration = np.where(times < dead_time, 0.0, acceleration)
    grid = np.linspace(0.0, paths.length, POINTS)
    lengths = arc_lengths(paths, grid)
    along = np.stack(
        [
            np.interp(one, sums, grid) + np.maximum(one - sums[-1], 0.0)
            for one, sums in zip(driven, lengths, strict=True)
        ]
    ).reshape(driven.shape)
    across, slope, bend = paths.at(along)
    return Motions(times, along, across, np.arctan(slope), curvature(slope, bend), speed, acceleration)


def arc_lengths(paths: QuinticPaths, grid: FloatArray) -> FloatArray:
    """Return ∫ √(1 + y′²) dx from 0 to each place of an ascending grid, shape (n, K) [m]."""
    _, slope, _ = paths.at(grid[None, :])
    stretch = np.sqrt(1.0 + slope**2)
    steps = 0.5 * (stretch[:, 1:] + stretch[:, :-1]) * np.diff(grid)
    return np.concatenate((np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)), axis=1)
