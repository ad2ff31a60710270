"""A1 to A4 with several pedestrians, the paper's future work: the chosen candidates and their distances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from controllers.drivable_area.avoidance import choose
from controllers.drivable_area.costs import CostWeights
from controllers.drivable_area.drivable_entropy import EntropyMode
from controllers.drivable_area.evaluation import Verdict
from controllers.drivable_area.pareto_search import Front
from controllers.prediction.social_force_model import Walkers
from studies.papers.claim import Claim, Kind, observed
from studies.papers.drivable_area.scenes import (
    BUDGET,
    PACE,
    RULES,
    SEED,
    WALKER,
    Situation,
    problem,
)

OTHERS: Final = ((1.5, -1.0, 1.0), (4.0, 3.5, -1.0))
"""Two more pedestrians: distance beyond the first [m], lateral start [m], and direction of walking."""
PROGRESS = 0.1
"""Weight of lost speed; without it, standing costs nothing and is always chosen."""
Chosen = tuple[Front, Verdict, int]


def walkers(one: Situation) -> Walkers:
    """Return the paper's pedestrian and the two others."""
    x = [one.distance, *(one.distance + more for more, _, _ in OTHERS)]
    y = [WALKER, *(across for _, across, _ in OTHERS)]
    ways = [-1.0, *(way for *_, way in OTHERS)]
    return Walkers(np.array(x), np.array(y), np.zeros(len(x)), PACE * np.array(ways))


def chosen_among_several(one: Situation) -> Chosen | None:
    """Return the result for all three pedestrians, with Shannon's entropy and a cost of lost speed."""
    rules = replace(RULES, entropy=EntropyMode.SHANNON, weights=CostWeights(progress=PROGRESS))
    scene = replace(problem(one), people=walkers(one))
    upper = np.array([3.5, one.speed])
    return choose(scene, rules, BUDGET, np.zeros(2), upper, np.zeros((0, 2)), SEED)


def several_claims(found: Mapping[Situation, Chosen | None]) -> list[Claim]:
    """Return the claims, one per situation, that the chosen candidate touches nobody."""
    claims = []
    for one, chosen in found.items():
        nearest = -np.inf
        ours = "no candidate"
        if chosen is not None:
            front, verdict, best = chosen
            nearest = -float(verdict.violations[best, 0])
            offset, speed = front.genes[best]
            ours = f"{offset:.2f} m, {3.6 * speed:.2f} km/h, {nearest:.2f} m between the discs"
        claims.append(
            observed(
                "002",
                f"{one.name}, three pedestrians",
                "The chosen candidate touches none of them.",
                kind=Kind.OWN,
                holds=nearest >= 0.0,
                ours=ours,
                test="distance at least 0",
                why="the paper's future work; two more pedestrians, 1.5 m and 4 m further along; lost speed "
                f"costs {PROGRESS:g}; without a limit of lateral acceleration",
            )
        )
    return claims


def draw_several(path: Path, found: Mapping[Situation, Chosen | None]) -> None:
    """Draw the paths of the front, the chosen path and the three pedestrians."""
    figure = Figure(figsize=(9.0, 9.0), layout="constrained")
    for axes, (one, chosen) in zip(figure.subplots(len(found), 1), found.items(), strict=True):
        x = np.linspace(0.0, one.distance + 6.0, 120)
        if chosen is not None:
            _, verdict, best = chosen
            paths = verdict.paths.at(x[None, :])[0]
            for i, each in enumerate(paths):
                label = "on the front" if i == 0 else None
                axes.plot(x, each, color="#999999", linewidth=0.5, label=label)
            axes.plot(x, paths[best], color="#0072B2", linewidth=2.5, label="chosen")
        else:
            axes.text(1.0, 1.5, "no candidate is possible", va="center", fontsize=9)
        people, times = walkers(one), np.arange(0.0, 2.6, 0.5)
        for i in range(len(people.x)):
            axes.plot(
                np.full(len(times), people.x[i]),
                people.y[i] + people.y_speed[i] * times,
                "o",
                markersize=4.0,
                color="#009E73",
                label="pedestrian, every 0.5 s" if i == 0 else None,
            )
        axes.set_title(f"{one.name}: {one.speed_kmh:g} km/h, {one.distance:g} m", loc="left", fontsize=9)
        axes.set_ylabel("across [m]")
        axes.set_xlim(0.0, 26.0)
        axes.set_ylim(-2.0, 5.0)
    axes.set_xlabel("along [m]")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=3, frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
