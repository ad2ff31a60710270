"""Figures of the drivable-area paper's experiments."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from controllers.arrays import FloatArray
from controllers.drivable_area.costs import CostWeights
from controllers.drivable_area.evaluation import Verdict
from controllers.drivable_area.pareto_search import Front
from controllers.drivable_area.reaction_space import ReactionSpace
from studies.papers.drivable_area.rides import Ride
from studies.papers.drivable_area.scenes import (
    GRIP,
    LANE_WIDTH,
    OWN,
    PACE,
    RULES,
    WALKER,
    Situation,
    at_the_table,
    grid,
    problem,
    verdict,
)

# Okabe and Ito's colours, which colour-blind readers can tell apart.
OURS: Final = "#0072B2"
THEIRS: Final = "#D55E00"
PERSON: Final = "#009E73"
GREY: Final = "#999999"

Fronts = Mapping[Situation, tuple[Front, Verdict, int] | None]
"""Front, verdict and chosen candidate of each situation."""


def draw_candidates(path: Path, found: Fronts) -> None:
    """Draw the paths of the grid, coloured by their least cost, the chosen path and the path of Table 2."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    scale = ScalarMappable(Normalize(0.0, 0.15), "cividis")
    panels = figure.subplots(len(found), 1, sharex=True)
    for axes, (one, chosen) in zip(panels, found.items(), strict=True):
        judged = verdict(problem(one), RULES, *grid(one))
        costs = np.where(judged.feasible, CostWeights().total(judged.costs), np.inf)
        for offset in np.unique(grid(one)[0]):
            same = np.flatnonzero(grid(one)[0] == offset)
            best = int(same[np.argmin(costs[same])])
            x = np.linspace(0.0, one.distance + 5.0, 120)
            y = judged.paths.at(x[None, :])[0][best]
            if np.isfinite(costs[best]):
                axes.plot(x, y, color=scale.to_rgba(costs[best]), linewidth=1.5)
            else:
                axes.plot(x, y, ":", color=GREY, linewidth=0.8)
        _draw_surroundings(axes, one)
        x = np.linspace(0.0, one.distance + 5.0, 120)
        table = at_the_table(one)
        axes.plot(x, table.paths.at(x[None, :])[0][0], "--", color=THEIRS, label="Table 2")
        if chosen is not None:
            _, own, best = chosen
            axes.plot(x, own.paths.at(x[None, :])[0][best], color=OURS, linewidth=2.5, label="chosen")
        axes.set_title(f"{one.name}: {one.speed_kmh:g} km/h, {one.distance:g} m", loc="left", fontsize=9)
        axes.set_ylabel("across [m]")
        axes.set_ylim(-0.2, 2.0 * LANE_WIDTH - 1.0)
    panels[-1].set_xlabel("along [m]")
    figure.colorbar(scale, ax=list(panels), label="least weighted cost over the final speeds")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    _save(figure, path)


def _draw_surroundings(axes: Axes, one: Situation) -> None:
    space = ReactionSpace(one.speed).outline(40)
    axes.fill(space[:, 0], space[:, 1] + OWN, color=GREY, alpha=0.25, linewidth=0.0, label="reaction space")
    times = np.arange(0.0, 2.6, 0.5)
    axes.plot(
        np.full(len(times), one.distance), WALKER - PACE * times, "o", color=PERSON, markersize=4.0,
        label="pedestrian, every 0.5 s",
    )  # fmt: skip
    axes.axhline(LANE_WIDTH, color="black", linewidth=0.5)


def draw_speeds(path: Path, found: Fronts) -> None:
    """Draw speeds over time: trapezoid and cubic to Table 2's final speed, and the chosen speed."""
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    panels = figure.subplots(*_square(found), sharex=True, sharey=True)
    for axes, (one, chosen) in zip(panels.flat, found.items(), strict=True):
        table = at_the_table(one)
        times = RULES.times
        shown = times <= 4.0
        trapezoid = one.braking_to(one.found.speed_kmh / 3.6)
        axes.plot(
            times[shown],
            3.6 * trapezoid.velocity(times)[shown],
            ":",
            color=THEIRS,
            label="Table 2, trapezoid",
        )
        axes.plot(
            times[shown], 3.6 * table.motions.speed[0][shown], "--", color=THEIRS, label="Table 2, smoothed"
        )
        if chosen is not None:
            _, own, best = chosen
            axes.plot(times[shown], 3.6 * own.motions.speed[best][shown], color=OURS, label="chosen")
        axes.set_title(one.name, loc="left", fontsize=9)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("speed [km/h]")
    axes.legend(frameon=False)
    _save(figure, path)


def draw_curvatures(path: Path, found: Fronts) -> None:
    """Draw the curvature along the path, and the limit of the tyres at the speed there."""
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    for axes, (one, chosen) in zip(figure.subplots(*_square(found)).flat, found.items(), strict=True):
        drawn = [("Table 2", "--", THEIRS, at_the_table(one), 0)]
        if chosen is not None:
            drawn.append(("chosen", "-", OURS, chosen[1], chosen[2]))
        for label, style, color, judged, index in drawn:
            moving = judged.motions
            rolls = moving.speed[index] > 0.2
            axes.plot(
                moving.along[index][rolls], moving.curvature[index][rolls], style, color=color, label=label
            )
            if label == "Table 2":
                limit = GRIP / np.maximum(moving.speed[index][rolls], 1.0) ** 2
                for sign in (1.0, -1.0):
                    axes.plot(
                        moving.along[index][rolls], sign * limit, color=GREY, linewidth=0.8,
                        label="friction limit at the table's speed" if sign > 0.0 else None,
                    )  # fmt: skip
        axes.set_xlim(0.0, one.distance)
        axes.set_ylim(-0.2, 0.2)
        axes.set_title(one.name, loc="left", fontsize=9)
        axes.set_xlabel("along [m]")
        axes.set_ylabel("curvature [1/m]")
    axes.legend(frameon=False, fontsize=8)
    _save(figure, path)


def draw_fronts(path: Path, found: Fronts) -> None:
    """Draw the Pareto fronts: curvature against distance, coloured by entropy."""
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    panels = figure.subplots(*_square(found))
    scale = ScalarMappable(Normalize(0.0, 0.05), "cividis")
    for axes, (one, chosen) in zip(panels.flat, found.items(), strict=True):
        if chosen is not None:
            front, _, best = chosen
            costs: FloatArray = front.costs
            axes.scatter(costs[:, 0], costs[:, 1], c=scale.to_rgba(costs[:, 2]), s=14)
            axes.plot(costs[best, 0], costs[best, 1], "s", color=OURS, fillstyle="none", label="chosen")
        axes.plot(one.found.curvature, one.found.distance, "x", color=THEIRS, label="Table 2")
        axes.set_title(one.name, loc="left", fontsize=9)
        axes.set_xlabel("cost of curvature")
        axes.set_ylabel("cost of distance [1/m]")
    panels.flat[0].legend(frameon=False)
    figure.colorbar(scale, ax=list(panels.flat), label="cost of entropy [1/m²]")
    _save(figure, path)


def draw_rides(path: Path, rides: Mapping[Situation, tuple[Ride, Ride, Ride]]) -> None:
    """Draw path, speed and distance to the pedestrian of the closed-loop rides."""
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    names = ("AEB", "drivable_area, beyond friction", "drivable_area, within friction")
    styles = ((GREY, "-"), (THEIRS, "--"), (OURS, "-"))
    panels = figure.subplots(len(rides), 3)
    for row, (one, driven) in zip(panels, rides.items(), strict=True):
        for ride, name, (color, style) in zip(driven, names, styles, strict=True):
            x, y, _, speed = ride.track
            shown = np.array(ride.times) <= 5.0
            moved = x[shown] - ride.body.front
            row[0].plot(moved, y[shown] + OWN, style, color=color, label=name)
            row[1].plot(np.array(ride.times)[shown], 3.6 * speed[shown], style, color=color)
            row[2].plot(np.array(ride.times)[shown], ride.clearances[shown], style, color=color)
        row[0].axvline(one.distance, color=PERSON, linewidth=0.8, label="pedestrian's way")
        row[0].set_xlim(0.0, one.distance + 10.0)
        row[0].set_ylim(1.0, 3.5)
        row[0].set_ylabel(f"{one.name}: across [m]")
        row[1].set_ylabel("speed [km/h]")
        row[2].set_ylabel("distance of bodies [m]")
        row[2].set_ylim(-1.0, 5.0)
        row[2].axhline(0.0, color="black", linewidth=0.5)
    panels[-1][0].set_xlabel("along [m]")
    panels[-1][1].set_xlabel("time [s]")
    panels[-1][2].set_xlabel("time [s]")
    figure.legend(
        *panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False
    )
    _save(figure, path)


def _square(found: Fronts) -> tuple[int, int]:
    """Return rows and columns of panels, two in a row."""
    return (len(found) + 1) // 2, 2


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=110, metadata={"Software": None})
