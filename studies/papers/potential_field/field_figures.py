"""Figures of the potential's parts (Figs 3, 4, 6 of the paper), and of car and pedestrian (Figs 12 to 15)."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from controllers.arrays import FloatArray
from controllers.potential_field.field import Gains
from studies.papers.potential_field.scenes import (
    CAR_LENGTH,
    CAR_WIDTH,
    EDGE,
    PEDESTRIAN_RADIUS,
    SAFE,
    SCENES,
    Scene,
    Track,
    field_of,
)

CAR: Final = "#D55E00"
PERSON: Final = "#009E73"
INSTANTS = 9
"""Number of instants at which car and pedestrian are drawn; at the fifth they are level."""
USED: Final = Gains()


def draw_parts(path: Path) -> None:
    """Draw each part of the potential alone, with the gains in use: those of the road, and the ellipse."""
    figure = Figure(figsize=(10.0, 6.0), layout="constrained")
    grid = figure.subplots(2, 3)
    y = np.linspace(-3.7, 3.7, 201)
    named = {
        "centre line of the left lane (Fig. 3a)": {"centre": USED.centre},
        "edges of the road (Fig. 4a)": {"edge": USED.edge},
        "line between the lanes (Fig. 4b)": {"line": USED.line},
    }
    for axes, (title, gain) in zip((grid[0, 0], grid[0, 2], grid[1, 0]), named.items(), strict=True):
        axes.plot(y, _potential(np.zeros_like(y), y, **gain))
        axes.set_xlabel("across [m]")
        axes.set_title(title, loc="left", fontsize=9)
    x = np.linspace(0.0, 100.0, 201)
    grid[0, 1].plot(x, _potential(x, np.full_like(x, 2.0), onwards=USED.onwards))
    grid[0, 1].set_xlabel("along [m]")
    grid[0, 1].set_title("pull onwards (Fig. 3b)", loc="left", fontsize=9)
    scene = SCENES[0]
    along, across = np.meshgrid(np.linspace(0.0, 100.0, 201), np.linspace(-4.0, 8.0, 121))
    values = _potential(along, across, obstacle=USED.obstacle)
    drawn = grid[1, 1].contourf(along, across, values, levels=12, cmap="viridis")
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    grid[1, 1].plot(
        scene.x + scene.long_axis * np.cos(turn), scene.y + SAFE * np.sin(turn), color="white", linewidth=0.8
    )
    grid[1, 1].set_title(
        f"pedestrian at (50, 3): σx = {scene.long_axis:.2f}, σy = {SAFE:.2f} m (Fig. 6)",
        loc="left",
        fontsize=9,
    )
    grid[1, 1].set_xlabel("along [m]")
    grid[1, 1].set_ylabel("across [m]")
    figure.colorbar(drawn, ax=grid[1, 1])
    for name, cut in (("along, at y = 3 m", True), ("across, at x = 50 m", False)):
        at = np.linspace(-40.0, 40.0, 201) if cut else np.linspace(-6.0, 6.0, 201)
        u = (
            _potential(50.0 + at, np.full_like(at, 3.0), obstacle=USED.obstacle)
            if cut
            else _potential(np.full_like(at, 50.0), 3.0 + at, obstacle=USED.obstacle)
        )
        grid[1, 2].plot(at, u, label=name)
    grid[1, 2].set_xlabel("distance from the pedestrian [m]")
    grid[1, 2].set_ylim(0.0, 0.42)
    grid[1, 2].legend(frameon=False, fontsize=8, loc="upper center")
    for axes in grid.flat:
        if axes is not grid[1, 1]:
            axes.set_ylabel("potential")
    _save(figure, path)


def draw_outlines(path: Path, tracks: dict[str, Track]) -> None:
    """Draw the car's outline and the pedestrian at nine instants of each planned path."""
    figure = Figure(figsize=(10.0, 9.0), layout="constrained")
    for axes, scene in zip(figure.subplots(4, 1, sharex=True), SCENES, strict=True):
        _draw_instants(axes, scene, tracks[scene.name])
    axes.set_xlabel("along [m]")
    _save(figure, path)


def _draw_instants(axes: Axes, scene: Scene, track: Track) -> None:
    times = np.linspace(0.0, 2.0 * scene.meeting, INSTANTS)
    x, y, heading = (np.interp(times, track.times, one) for one in (track.x, track.y, track.heading))
    walked = scene.places(times)
    half, side = 0.5 * CAR_LENGTH, 0.5 * CAR_WIDTH
    # A pentagon, as in the paper: its point shows the direction of travel.
    outline = np.array([(-half, -side), (half - 1.0, -side), (half, 0.0), (half - 1.0, side), (-half, side)])
    for k in range(INSTANTS):
        cosine, sine = np.cos(heading[k]), np.sin(heading[k])
        corners = outline @ np.array([[cosine, sine], [-sine, cosine]]) + (x[k], y[k])
        axes.add_patch(Polygon(corners, closed=True, fill=False, edgecolor=CAR))
        axes.add_patch(Circle((walked[0][k], walked[1][k]), PEDESTRIAN_RADIUS, fill=False, edgecolor=PERSON))
        axes.plot([x[k], walked[0][k]], [y[k], walked[1][k]], color="#999999", linewidth=0.6)
        axes.annotate(str(k + 1), (x[k], y[k] - 1.9), ha="center", va="top", fontsize=7)
    for edge in (-EDGE, EDGE):
        axes.axhline(edge, color="black")
    axes.axhline(0.0, color="black", linewidth=0.6, linestyle=(0, (8, 8)))
    axes.set_ylim(-EDGE - 0.5, EDGE + 0.8)
    axes.set_xlim(-4.0, 110.0)
    axes.set_ylabel("across [m]")
    axes.set_title(
        f"scene {scene.name} (Fig. {11 + int(scene.name)}): nearest {track.clearance:.2f} m",
        loc="left",
        fontsize=9,
    )


def _potential(x: FloatArray, y: FloatArray, **gains: float | FloatArray) -> FloatArray:
    """Return the potential of scene 1 with only the given gains."""
    nothing = {"onwards": 0.0, "centre": 0.0, "edge": 0.0, "line": 0.0, "obstacle": 0.0}
    scene = SCENES[0]
    return np.asarray(field_of(scene, scene.long_axis, Gains(**{**nothing, **gains})).potential(x, y))


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=110, metadata={"Software": None})
