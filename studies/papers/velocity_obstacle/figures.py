"""Figures of the velocity-obstacle paper's experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from controllers.arrays import FloatArray
from controllers.driving.lanes.septic_path import SepticPath
from studies.papers.velocity_obstacle.scenes import RADIUS, STEP, Scene, people
from studies.papers.velocity_obstacle.search import Spread

# Okabe and Ito's colours, which colour-blind readers can tell apart.
COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9")
PERSON: Final = "#000000"


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion to draw, with x to the right and y forward as in the paper."""

    name: str
    time: FloatArray
    x: FloatArray
    y: FloatArray
    speed: FloatArray
    heading: FloatArray
    """Heading from the x-axis [rad]."""
    stepped: bool = True
    """Whether the acceleration is constant within each step."""


def of_states(name: str, states: FloatArray) -> Motion:
    """Return the motion of states of an Euler bicycle."""
    along, across, heading, speed, _ = states
    return Motion(name, STEP * np.arange(float(len(along))), -across, along, speed, 0.5 * np.pi + heading)


def of_septic(name: str, path: SepticPath, begins: float, speed: float, until: float) -> Motion:
    """Return the motion along a septic path at constant speed along the road."""
    y = np.linspace(0.0, until, 200)
    places = [path.at(float(along) - begins) for along in y]
    slope = np.array([place.slope for place in places])
    across = np.array([place.across for place in places])
    fast = speed * np.sqrt(1.0 + slope**2)
    return Motion(name, y / speed, -across, y, fast, 0.5 * np.pi + np.arctan(slope), False)


def draw_motions(path: Path, scene: Scene, motions: Sequence[Motion]) -> None:
    """Draw paths, speeds, accelerations and headings of one experiment."""
    figure = Figure(figsize=(9.0, 6.6), layout="constrained")
    (where, fast), (pushed, turned) = figure.subplots(2, 2)
    who = people(scene)
    where.plot(
        -who.across[0], who.along[0], "o", color=PERSON, markersize=3.0, label="pedestrian, by seconds"
    )
    for motion, colour in zip(motions, COLOURS, strict=False):
        where.plot(motion.x, motion.y, "." if motion.stepped else "-", color=colour, markersize=5.0)
        where.plot(motion.x, motion.y, "-", color=colour, linewidth=1.0, label=motion.name)
        fast.plot(motion.time, motion.speed, color=colour)
        times, values = _acceleration(motion)
        pushed.plot(times, values, color=colour, drawstyle="steps-post" if motion.stepped else "default")
        turned.plot(motion.time, np.rad2deg(motion.heading), color=colour)
    where.set_xlim(-5.0, 7.5)
    where.set_xlabel("x, to the right [m]")
    where.set_ylabel("y, forward [m]")
    fast.set_ylabel("speed [m/s]")
    pushed.set_ylabel("acceleration [m/s²]")
    turned.set_ylabel("heading from the x-axis [°]")
    for axes in (fast, pushed, turned):
        axes.set_xlabel("time [s]")
        axes.set_xlim(0.0, scene.steps)
    figure.suptitle(
        f"{scene.name}: disc of {RADIUS:g} m, pedestrian at x = 0, y = {scene.crossing_y:g} m at 7 s",
        fontsize=10,
    )
    figure.legend(*where.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    _save(figure, path)


def draw_spread(path: Path, spreads: Mapping[str, Spread]) -> None:
    """Draw the genetic algorithm's result for each seed, and the optimum of the programs."""
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    costs, paths = figure.subplots(1, 2, width_ratios=(3, 2))
    for index, (name, one) in enumerate(spreads.items()):
        shifts = np.linspace(-0.25, 0.25, len(one.costs))
        costs.plot(index + shifts, np.sort(one.costs) / one.best.cost, "o", color=COLOURS[0], markersize=4.0)
        label = f"{name}\n{one.budget.generations} × {one.budget.population} plans"
        costs.text(index, 0.93, label, ha="center", va="top", fontsize=8)
    costs.axhline(1.0, color=COLOURS[1], label="sequential quadratic programs")
    costs.set_xticks([])
    costs.set_ylim(0.7, None)
    costs.set_yscale("log")
    costs.set_yticks([1.0, 2.0, 5.0], ["1", "2", "5"])
    costs.set_ylabel("objective J over the optimum")
    costs.legend(frameon=False, loc="upper left")
    last = list(spreads.values())[-1]
    for plan in last.plans:
        paths.plot(-plan.states[1], plan.states[0], color=COLOURS[0], linewidth=0.6)
    paths.plot(-last.best.states[1], last.best.states[0], color=COLOURS[1], linewidth=2.0)
    paths.set_xlabel("x, to the right [m]")
    paths.set_ylabel("y, forward [m]")
    paths.set_title(f"{list(spreads)[-1]}: paths of all seeds", fontsize=9, loc="left")
    _save(figure, path)


def draw_risk(path: Path, curves: Mapping[str, tuple[FloatArray, FloatArray]]) -> None:
    """Draw coefficients of risk perception k = l / v over time."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.add_subplot()
    for (name, (times, values)), colour in zip(curves.items(), COLOURS, strict=False):
        axes.plot(times, values, color=colour, label=f"{name}: mean {values.mean():.2f} s")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("coefficient of risk perception k = l / v [s]")
    axes.legend(frameon=False)
    _save(figure, path)


def _acceleration(motion: Motion) -> tuple[FloatArray, FloatArray]:
    if motion.stepped:
        values = np.diff(motion.speed) / STEP
        return motion.time, np.append(values, values[-1])
    return motion.time, np.gradient(motion.speed, motion.time)


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=130, metadata={"Software": None})
