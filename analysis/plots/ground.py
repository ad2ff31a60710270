"""The road from above: lanes, crossings and walking areas of map.json, and the outlines of road users."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from analysis.arrays import FloatArray
from analysis.recording.reading import Area

# Okabe and Ito's colours, which colour-blind readers can tell apart.
EGO: Final = "#0072B2"
PERSON: Final = "#D55E00"
VEHICLE: Final = "#999999"
PLAN: Final = "#56B4E9"
ROAD: Final = "#e4e4e4"
WALK: Final = "#f3eee0"
CROSSING: Final = {"zebra": "#ffffff", "unmarked": "#d0d0d0", "signal": "#cfe8df", "": "#d0d0d0"}
"""Colours of crossings, by kind."""
SLIMMEST: Final = 4.0
"""A map is at most this many times as long as wide."""


def draw_ground(axes: Axes, areas: Sequence[Area]) -> None:
    """Draw the map: lanes at the bottom, then walking areas, then crossings."""
    lanes = [ribbon(area.shape, area.width_m) for area in areas if area.kind == "lane"]
    walks = [area.shape for area in areas if area.kind == "walkingarea"]
    axes.add_collection(PolyCollection(lanes, facecolors=ROAD, edgecolors="#ffffff", linewidths=0.6))
    axes.add_collection(PolyCollection(walks, facecolors=WALK, edgecolors="none", zorder=1.1))
    for area in areas:
        if area.kind == "crossing":
            outline = [ribbon(area.shape, area.width_m)]
            color = CROSSING[area.crossing_kind]
            axes.add_collection(
                PolyCollection(outline, facecolors=color, edgecolors="#707070", linewidths=0.8, zorder=1.2)
            )


def ribbon(line: FloatArray, width_m: float) -> FloatArray:
    """Return the outline of a band of some width along a line [m].

    >>> ribbon(np.array([[0.0, 0.0], [10.0, 0.0]]), 2.0).tolist()
    [[0.0, 1.0], [10.0, 1.0], [10.0, -1.0], [0.0, -1.0]]
    """
    tangent = np.gradient(line, axis=0)
    length = np.maximum(np.hypot(*tangent.T), 1e-9)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / length[:, None] * (0.5 * width_m)
    return np.concatenate([line + normal, (line - normal)[::-1]])


def rectangle(x: float, y: float, heading: float, length: float, width: float) -> FloatArray:
    """Return the corners of a body from its centre [m] and heading [rad].

    >>> rectangle(0.0, 0.0, 0.0, 4.0, 2.0).tolist()
    [[2.0, 1.0], [-2.0, 1.0], [-2.0, -1.0], [2.0, -1.0]]
    """
    corners = np.array([[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]]) * (length, width)
    cos, sin = np.cos(heading), np.sin(heading)
    turned: FloatArray = corners @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
    return turned


def limits(points: FloatArray, margin_m: float) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of a box around points that is not too narrow [m].

    >>> low, high = limits(np.array([[0.0, 0.0], [80.0, 0.0]]), 0.0)
    >>> low.tolist(), high.tolist()
    ([0.0, -10.0], [80.0, 10.0])
    """
    low, high = points.min(axis=0) - margin_m, points.max(axis=0) + margin_m
    size = np.maximum(high - low, (high - low).max() / SLIMMEST)
    middle = 0.5 * (low + high)
    return middle - 0.5 * size, middle + 0.5 * size
