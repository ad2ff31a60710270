"""The figure of the page: measures over the share of egos."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from analysis.statistics.intervals import mean_interval
from studies.penetration.outcomes import MEASURES, WHO, Outcome

COLOURS = dict(zip(WHO, ("#333333", "#0072B2", "#D55E00"), strict=True))
ASIDE = 0.015
"""Offset in share by which intervals of the same share are drawn beside each other."""
SHOWN = ("conflicts_per_1000_ped", "conflicts", "severe", "ped_delay", "vehicle_delay", "throughput")


def draw(found: Sequence[Outcome], path: Path) -> None:
    """Draw each measure over the share, with 95 % intervals over seeds."""
    shares = sorted({one.share for one in found})
    figure = Figure(figsize=(9.6, 5.6), layout="constrained")
    grid = figure.subplots(2, 3, sharex=True).ravel()
    measures = {measure.name: measure for measure in MEASURES}
    for axes, name in zip(grid, SHOWN, strict=True):
        measure = measures[name]
        for number, who in enumerate(WHO if measure.split else WHO[:1]):
            places, means, below, above = [], [], [], []
            for share in shares:
                values = np.array(
                    [one.values.get((name, who), np.nan) for one in found if one.share == share]
                )
                values = values[np.isfinite(values)]
                if not len(values):
                    continue
                ends = mean_interval(values)
                places.append(share + ASIDE * number)
                means.append(float(values.mean()))
                below.append(means[-1] - ends.low if ends else 0.0)
                above.append(ends.high - means[-1] if ends else 0.0)
            axes.errorbar(places, means, [below, above], color=COLOURS[who], marker="o", capsize=2, label=who)
        axes.set_title(f"{measure.title}\n[{measure.unit}]", loc="left", fontsize=8)
        axes.set_ylim(bottom=0.0)
    for axes in grid[3:]:
        axes.set_xlabel("ego_share")
    figure.legend(*grid[1].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    with matplotlib.rc_context({"svg.hashsalt": "cosim"}):
        figure.savefig(path, metadata={"Date": None})
