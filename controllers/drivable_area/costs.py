"""Costs of a candidate: nearness at speed, curvature, and the weights of these and of the entropy."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.motions import POINTS, arc_lengths
from controllers.drivable_area.quintic_path import QuinticPaths, curvature

PAPER_GRAVITY = 9.8
"""Gravity as in the paper's safety coefficient [m/s^2]."""


class SpeedRisk(StrEnum):
    """Readings of the safety coefficient C_vs, which the paper does not define completely."""

    METRES_PER_SECOND = "m/s"
    """3.6 v_s / (2 · 9.8) / 9.8 with v_s in m/s."""
    KILOMETRES_PER_HOUR = "km/h"
    """The same with v_s in km/h."""
    SQUARED = "squared"
    """v_s² / (2 · 9.8) / 9.8 with v_s in m/s."""
    STOPPING_DISTANCE = "stopping_distance"
    """v_s² / (2 · 9.8) with v_s in m/s."""


def speed_risk(final_speed: FloatArray, form: SpeedRisk) -> FloatArray:
    """Return the safety coefficient C_vs of a final speed.

    Parameters
    ----------
    final_speed : v_s [m/s]
    form : the reading

    Notes
    -----
    Table 1 of [Wu2023]_ prints (3.6 v_s / (2 · 9.8)) / 9.8 without a unit for v_s. The squared forms assume
    that a square is missing.

    >>> speed_risk(np.array([5.0]), SpeedRisk.METRES_PER_SECOND).round(4).tolist()
    [0.0937]
    """
    doubled = 2.0 * PAPER_GRAVITY
    if form is SpeedRisk.METRES_PER_SECOND:
        return 3.6 * final_speed / doubled / PAPER_GRAVITY
    if form is SpeedRisk.KILOMETRES_PER_HOUR:
        return 3.6 * 3.6 * final_speed / doubled / PAPER_GRAVITY
    squared = np.asarray(final_speed**2 / doubled)
    return squared if form is SpeedRisk.STOPPING_DISTANCE else squared / PAPER_GRAVITY


LEAST_CLEARANCE = 0.05
"""A smaller clearance counts as this in the cost, which therefore stays finite [m]."""


def distance_cost(risk: FloatArray, clearance: FloatArray) -> FloatArray:
    """Return C_vs divided by the clearance d_cp − r_veh − r_pe [1/m].

    Parameters
    ----------
    risk : C_vs, shape (n,)
    clearance : smallest clearance on the way, inf if nobody is there, shape (n,) [m]

    Notes
    -----
    Eq. (45) of [Wu2023]_.
    """
    return np.asarray(risk / np.maximum(clearance, LEAST_CLEARANCE))


def curvature_cost(paths: QuinticPaths, largest: float) -> FloatArray:
    """Return ∫ |κ| ds / (k_max L) up to the end of the avoidance, shape (n,).

    Parameters
    ----------
    paths : n paths of length L
    largest : k_max [1/m]

    Notes
    -----
    Eq. (46) of [Wu2023]_; k_max is not published.
    """
    grid = np.linspace(0.0, paths.length, POINTS)
    _, slope, bend = paths.at(grid[None, :])
    size = np.abs(curvature(slope, bend))
    driven = arc_lengths(paths, grid)
    summed = (0.5 * (size[:, 1:] + size[:, :-1]) * np.diff(driven, axis=1)).sum(axis=1)
    return np.asarray(summed / (largest * driven[:, -1]))


@dataclass(frozen=True, slots=True)
class CostWeights:
    """How the costs of a candidate add up.

    Notes
    -----
    Eq. (48) and Table 1 of [Wu2023]_. The paper calls J_c a weight of safety and J_d one of stability: the
    names are swapped, but the values are equal. ``progress`` is not in the paper; without it, standing still
    costs nothing.
    """

    curvature: float = 0.2
    """J_c"""
    distance: float = 0.2
    """J_d"""
    entropy: float = 0.6
    """J_s"""
    progress: float = 0.0
    """Weight of 1 − v_s / v_max, the lost share of the speed."""

    def total(self, costs: FloatArray) -> FloatArray:
        """Return the weighted sums; columns are curvature, distance, entropy and progress, shape (n, 4)."""
        weights = np.array([self.curvature, self.distance, self.entropy, self.progress])
        return np.asarray(costs @ weights)
