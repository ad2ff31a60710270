"""Figures of the intermediate-speed paper's experiments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.papers.intermediate_speed.drives import Driven

if TYPE_CHECKING:
    from studies.papers.intermediate_speed.experiments import Delayed, Pair

# Okabe and Ito's colours, which colour-blind readers can tell apart.
BLUE: Final = "#0072B2"
VERMILION: Final = "#D55E00"
GREEN: Final = "#009E73"
GREY: Final = "#777777"

Line = tuple[str, str, Driven]
"""Name, colour and drive of a line in a figure."""


def draw_experiments(path: Path, classic: Pair, new: Pair) -> None:
    """Draw the four experiments, with some of the planned speeds."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    columns = (("standing obstacle", "standing"), ("obstacle at 5 m/s", "moving"))
    grid = figure.subplots(3, 2, sharex="col")
    for axes, (title, which) in zip(grid.T, columns, strict=True):
        lines = [
            ("classic", VERMILION, getattr(classic, which)),
            ("intermediate speed", BLUE, getattr(new, which)),
        ]
        _draw(axes, lines)
        for _, color, drive in lines:
            for begun, speeds in drive.planned:
                axes[1].plot(begun + drive.plan_times, speeds, ":", color=color, linewidth=0.8)
        axes[0].set_title(title, loc="left", fontsize=9)
    grid[1, 0].plot([], [], ":", color=GREY, label="planned")
    figure.legend(*grid[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    _save(figure, path)


def draw_delay(path: Path, delayed: Delayed) -> None:
    """Draw the drives with slow actuators."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    grid = figure.subplots(3, 2, sharex="col")
    columns = (("standing obstacle", "standing"), ("obstacle at 5 m/s", "moving"))
    for axes, (title, which) in zip(grid.T, columns, strict=True):
        _draw(
            axes,
            [
                ("every 0.1 s, commanded speed", VERMILION, getattr(delayed.naive, which)),
                ("by events, commanded speed", BLUE, getattr(delayed.event, which)),
                ("every 0.1 s, predicted state", GREEN, getattr(delayed.predicted, which)),
            ],
        )
        axes[0].set_title(title, loc="left", fontsize=9)
    figure.legend(*grid[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    _save(figure, path)


def draw_smooth(path: Path, plain: Driven, smooth: Driven) -> None:
    """Draw the drives behind the moving obstacle with and without a jerk limit."""
    figure = Figure(figsize=(6.4, 7.0), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    _draw(axes, [("no limit", VERMILION, plain), ("jerk of at most 1 m/s³", BLUE, smooth)])
    axes[0].set_xlim(0.0, 60.0)
    figure.legend(*axes[1].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    _save(figure, path)


def _draw(axes: Sequence[Axes], lines: Sequence[Line]) -> None:
    """Draw gap, speed and acceleration of several drives behind the same obstacle."""
    # The first lines are wider, so that lines on top of each other stay visible.
    for (name, color, drive), width in zip(lines, (2.4, 1.4, 0.8), strict=False):
        axes[0].plot(drive.time, drive.gap, color=color, linewidth=width)
        axes[1].plot(drive.time, drive.speed, color=color, linewidth=width, label=name)
        axes[2].plot(drive.time, drive.acceleration, color=color, linewidth=0.6 * width)
    first = lines[0][2]
    axes[1].plot(first.time, first.obstacle_speed, "--", color=GREY, linewidth=1.0, label="obstacle")
    for one, label in zip(axes, ("gap [m]", "speed [m/s]", "acceleration [m/s²]"), strict=True):
        one.set_ylabel(label)
        one.grid(visible=True, linewidth=0.3)
    axes[2].set_xlabel("time [s]")


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=120, metadata={"Software": None})
