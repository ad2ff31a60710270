"""Space–time diagram: the ego's position along its path, and when pedestrians are in that path."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.arrays import FloatArray
from analysis.plots.ground import EGO, PERSON
from analysis.plots.scene import Piece, Scene

NEAR_M = 8.0
"""Pedestrians are drawn while they are within this distance of the ego's path [m]."""
BEYOND_M = 45.0
"""The ego's path is extended straight on by this length at its end [m]."""


def draw_space_time(scene: Scene) -> Figure:
    """Return the figure; a pedestrian's line is bold while they are within the width of the ego's body."""
    figure = Figure(figsize=(9.0, 5.5), layout="constrained")
    axes = figure.add_subplot()
    origin = 0.0
    for ego in scene.pieces():
        along = ego.track.path[ego.part]
        if not origin:
            origin = float(along[0])
        front, rear = along + 0.5 * ego.track.length, along - 0.5 * ego.track.length
        axes.fill_between(ego.time, rear - origin, front - origin, color=EGO, alpha=0.8, linewidth=0.0)
        axes.plot(ego.time, front - origin, color=EGO, linewidth=0.8, label="ego, front to rear")
        for person in scene.persons():
            _person(axes, ego, person, origin)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("along the ego's way [m]")
    axes.set_xlim(scene.begin_s, scene.end_s)
    axes.set_title(scene.name, fontsize=9)
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    axes.legend(unique.values(), unique.keys(), frameon=False, fontsize=8)
    return figure


def _person(axes: Axes, ego: Piece, person: Piece, origin: float) -> None:
    line = driven_line(ego)
    along, across = beside(line, np.column_stack([person.x, person.y]))
    along = along + ego.track.path[ego.part][0] - origin
    near = np.abs(across) <= NEAR_M
    if not near.any():
        return
    half = 0.5 * ego.track.width + 0.5 * person.track.width
    label = f"pedestrian within {NEAR_M:g} m of the way"
    axes.plot(person.time, np.where(near, along, np.nan), color=PERSON, linewidth=0.8, alpha=0.7, label=label)
    bold = np.where(np.abs(across) <= half, along, np.nan)
    axes.plot(person.time, bold, color=PERSON, linewidth=3.5, label="pedestrian in the ego's path")


def driven_line(ego: Piece) -> FloatArray:
    """Return the path of the ego's centre as distinct points, with a straight extension, shape (n, 2) [m]."""
    points = np.column_stack([ego.x, ego.y])
    moved = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-3])
    heading = float(ego.heading[-1])
    beyond = points[-1] + BEYOND_M * np.array([np.cos(heading), np.sin(heading)])
    return np.concatenate([points[moved], beyond[None, :]])


def beside(line: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance of each point along a line and to its left [m].

    >>> along, across = beside(np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([[4.0, 3.0]]))
    >>> float(along[0]), float(across[0])
    (4.0, 3.0)
    """
    start, chord = line[:-1], np.diff(line, axis=0)
    length = np.hypot(*chord.T)
    before = np.concatenate([[0.0], np.cumsum(length)])[:-1]
    along, across = np.empty(len(points)), np.empty(len(points))
    for index, point in enumerate(points):
        offset = point - start
        share = np.clip((offset * chord).sum(axis=1) / length**2, 0.0, 1.0)
        gap = offset - share[:, None] * chord
        distance = np.hypot(*gap.T)
        best = int(np.argmin(distance))
        left = chord[best, 0] * offset[best, 1] - chord[best, 1] * offset[best, 0]
        along[index] = before[best] + share[best] * length[best]
        across[index] = np.copysign(distance[best], left)
    return along, across
