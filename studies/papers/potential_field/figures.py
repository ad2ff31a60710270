"""Figures of the potential-field paper's experiments."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from controllers.potential_field.field import Gains
from controllers.prediction.direction_choice import ANGLES, DirectionModel
from studies.papers.potential_field.scenes import EDGE, SCENES, Scene, Track, field_of
from studies.papers.potential_field.spread import EXAMPLE

# Okabe and Ito's colours, which colour-blind readers can tell apart.
VARIABLE: Final = "#0072B2"
FIXED: Final = "#D55E00"
PERSON: Final = "#009E73"
SHOWN_TO: Final = 110.0

Pairs = Mapping[str, tuple[Track, Track]]
"""Tracks with the fixed and the variable axis, by scene."""


def draw_directions(path: Path) -> None:
    """Draw the probability of each direction, for several scales of the choice model."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.add_subplot()
    for scale, style in ((0.02, ":"), (0.05, "-"), (0.1, "--")):
        model = DirectionModel(scale=scale)
        axes.plot(
            np.rad2deg(ANGLES),
            model.probabilities(EXAMPLE),
            style,
            color=VARIABLE,
            label=f"this model, m = {scale:g}",
        )
    axes.axvline(100.0, color=FIXED, linewidth=1.0, label="most probable in the paper")
    axes.set_xlabel("direction of walking against that of the cars [°]")
    axes.set_ylabel("probability of the alternative")
    axes.legend(frameon=False)
    _save(figure, path)


def draw_fields(path: Path, paths: Pairs, rides: Pairs) -> None:
    """Draw the potential on the road, with planned and driven paths."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    for axes, scene in zip(figure.subplots(4, 1, sharex=True), SCENES, strict=True):
        _draw_field(axes, scene)
        for track, color, name in zip(
            paths[scene.name], (FIXED, VARIABLE), ("fixed axis", "variable axis"), strict=True
        ):
            axes.plot(track.x, track.y, color=color, label=f"path, {name}")
        for track, color, name in zip(
            rides[scene.name], (FIXED, VARIABLE), ("fixed axis", "variable axis"), strict=True
        ):
            axes.plot(track.x, track.y, ".", color=color, markersize=3.5, label=f"driven, {name}")
        times = np.linspace(0.0, 2.0 * scene.meeting, 9)
        axes.plot(*scene.places(times), "o", color=PERSON, markersize=4.0, label="pedestrian, 9 instants")
        axes.set_ylim(-EDGE, EDGE + 0.4)
        axes.set_xlim(0.0, SHOWN_TO)
        axes.set_ylabel("across [m]")
        axes.set_title(f"scene {scene.name}: σx = {scene.long_axis:.2f} m", loc="left", fontsize=9)
    axes.set_xlabel("along [m]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    _save(figure, path)


def draw_curvatures(path: Path, paths: Pairs) -> None:
    """Draw the curvature of the planned paths."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    for axes, scene in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, SCENES, strict=True):
        for track, color, name in zip(
            paths[scene.name], (FIXED, VARIABLE), ("fixed", "variable"), strict=True
        ):
            axes.plot(track.x, track.bends, color=color, label=f"{name} axis")
        axes.set_xlim(0.0, SHOWN_TO)
        axes.set_title(f"scene {scene.name}", loc="left", fontsize=9)
        axes.set_xlabel("along [m]")
        axes.set_ylabel("curvature [1/m]")
    axes.legend(frameon=False)
    _save(figure, path)


def draw_distances(path: Path, rides: Pairs) -> None:
    """Draw the distance between the bodies over time in the driven scenes."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    for axes, scene in zip(figure.subplots(2, 2, sharex=True).flat, SCENES, strict=True):
        for track, color, name in zip(
            rides[scene.name], (FIXED, VARIABLE), ("fixed", "variable"), strict=True
        ):
            axes.plot(track.times, track.distances, color=color, label=f"{name} axis")
        axes.set_yscale("log")
        axes.set_title(f"scene {scene.name}", loc="left", fontsize=9)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("distance of the bodies [m]")
    axes.legend(frameon=False)
    _save(figure, path)


def _draw_field(axes: Axes, scene: Scene) -> None:
    """Draw the potential without the forward pull, which would hide the rest."""
    x, y = np.meshgrid(np.linspace(0.0, SHOWN_TO, 221), np.linspace(-3.7, 3.7, 149))
    shape = field_of(scene, scene.long_axis, Gains(onwards=0.0))
    potential = shape.potential(x, y)
    axes.contourf(x, y, np.minimum(potential, 0.7), levels=14, cmap="Greys", alpha=0.6)
    axes.axhline(0.0, color="black", linewidth=0.6, linestyle=(0, (8, 8)))


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=120, metadata={"Software": None})
