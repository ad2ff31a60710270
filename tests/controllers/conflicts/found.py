"""Conflicts with the path of an ego that keeps its lane, found among walkers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import Conflicts, find
from controllers.interface import CrossingKind, Perception
from controllers.prediction.forecast import Forecast
from controllers.velocity_obstacle.mpc.passing_classes import class_bounds
from tests.controllers.scenes import Walker, perception, straight_road, zebra

BAND = (-0.9, 0.9)
MARGIN = 0.6
# Half the band, the disc and the margin: the overlap lasts while |across| <= 1.75.
REACH = 0.9 + 0.25 + MARGIN
HORIZON = 6.0
TIMES = np.arange(0.5, 6.01, 0.5)
REAR = 0.95


def found_among(
    walkers: Sequence[Walker],
    scene: Perception | None = None,
    watch: Watch | None = None,
    assume: PedestrianAssumptions | None = None,
    forecast: Forecast | None = None,
) -> Conflicts:
    scene = scene or perception(walkers=walkers)
    return find(
        scene,
        watch or Watch(),
        BAND,
        MARGIN,
        HORIZON,
        assume or PedestrianAssumptions(),
        forecast,
    )


def on_zebra(walkers: Sequence[Walker], kind: CrossingKind = CrossingKind.ZEBRA) -> Perception:
    return perception(road=straight_road(3, 1), walkers=walkers, crossings=[zebra(28.0, kind)])


def position_bounds(
    found: Conflicts, behind: int, *arguments: Any
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the bounds of one passing class."""
    bounds = class_bounds(found, *arguments)
    return bounds.upper[behind], bounds.lower[behind], bounds.freeze[behind]
