"""The paths of the ego and of the pedestrians in the plane."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from analysis.plots.ground import EGO, PERSON, SLIMMEST, draw_ground, limits, rectangle
from analysis.plots.scene import Piece, Scene

WIDTH_IN = 9.0
MARGIN_M = 8.0
MARKS = 12
"""Approximate number of instants at which both are marked."""


def draw_plane(scene: Scene) -> Figure:
    """Return the figure; equal numbers mark equal instants."""
    pieces, persons = scene.pieces(), scene.persons()
    driven = np.concatenate([np.column_stack([one.x, one.y]) for one in pieces])
    # The window contains the ego's path and, for an encounter, the pedestrian's.
    shown = [driven]
    if scene.number is not None:
        shown += [np.column_stack([one.x, one.y]) for one in persons]
    points = np.concatenate(shown)
    low, high = limits(points, MARGIN_M)
    # A long trip along a straight road would look like a line, so y is enlarged.
    extent = np.ptp(points, axis=0) + 2.0 * MARGIN_M
    enlarged = bool(extent[1] < extent[0] / SLIMMEST)
    if enlarged:
        low[1], high[1] = points[:, 1].min() - MARGIN_M, points[:, 1].max() + MARGIN_M
    wide, tall = high - low
    height = WIDTH_IN / SLIMMEST if enlarged else WIDTH_IN * float(tall / wide)
    figure = Figure(figsize=(WIDTH_IN, height + 1.1), layout="constrained")
    axes = figure.add_subplot()
    draw_ground(axes, scene.case.run.areas)
    marks = _instants(scene)
    for piece in pieces:
        axes.plot(piece.x, piece.y, color=EGO, linewidth=1.5, label="ego", zorder=3)
        _bodies(axes, piece, marks)
    for piece in persons:
        axes.plot(piece.x, piece.y, color=PERSON, linewidth=1.0, label="pedestrian", zorder=3)
        if scene.number is not None:
            _dots(axes, piece, marks)
    axes.set_aspect("auto" if enlarged else "equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m], enlarged" if enlarged else "y [m]")
    axes.set_title(f"{scene.name}, {scene.begin_s:.1f} s to {scene.end_s:.1f} s", fontsize=9)
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=2, frameon=False)
    return figure


def _instants(scene: Scene) -> list[float]:
    """Return round times [s], about `MARKS` of them within the window."""
    duration = scene.end_s - scene.begin_s
    spacing = next((one for one in (0.5, 1.0, 2.0, 5.0, 10.0, 20.0) if duration / one <= MARKS), 60.0)
    first, last = np.ceil(scene.begin_s / spacing), np.floor(scene.end_s / spacing)
    return [float(number * spacing) for number in np.arange(first, last + 1.0)]


def _bodies(axes: Axes, piece: Piece, marks: list[float]) -> None:
    bodies = []
    for mark in marks:
        at = int(np.searchsorted(piece.time, mark - 1e-6))
        if at < len(piece.time) and abs(piece.time[at] - mark) < 0.03:
            track = piece.track
            x, y = float(piece.x[at]), float(piece.y[at])
            bodies.append(rectangle(x, y, float(piece.heading[at]), track.length, track.width))
            axes.annotate(
                f"{mark:g} s",
                (x, y),
                xytext=(0, 7),
                textcoords="offset points",
                fontsize=6,
                annotation_clip=True,
            )
    axes.add_collection(PolyCollection(bodies, facecolors="none", edgecolors=EGO, linewidths=0.8, zorder=3))


def _dots(axes: Axes, piece: Piece, marks: list[float]) -> None:
    for mark in marks:
        at = int(np.searchsorted(piece.time, mark - 1e-6))
        if at < len(piece.time) and abs(piece.time[at] - mark) < 0.03:
            x, y = float(piece.x[at]), float(piece.y[at])
            axes.plot(x, y, "o", color=PERSON, markersize=3.0, zorder=4)
            axes.annotate(
                f"{mark:g} s",
                (x, y),
                xytext=(4, 0),
                textcoords="offset points",
                fontsize=6,
                annotation_clip=True,
            )
