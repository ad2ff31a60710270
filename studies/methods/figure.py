"""Safety against delay: one point a method, with intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from analysis.statistics.intervals import mean_interval
from analysis.study.design import Study
from studies.methods.rows import Row

WIDTH, HEIGHT = 0.2, 0.1
"""Points nearer to each other than this share of the largest delay, and of all encounters, have labels that
would overlap."""
LINE = 11.0
"""Height of a line of text [points]."""


def draw(path: Path, study: Study, rows: Mapping[str, Row]) -> None:
    """Draw contacts per 100 encounters, with their exact interval, over the delay with that of the mean.

    Parameters
    ----------
    path : of the picture
    study : for the delay of every run
    rows : of each label over all conditions
    """
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.add_subplot()
    shown = {label: row for label, row in rows.items() if row.delay is not None and row.contact_share}
    heights = _heights([(row.delay or 0.0, row.contacts / row.encounters) for row in shown.values()])
    for (label, row), height in zip(shown.items(), heights, strict=True):
        if row.delay is None or row.contact_share is None:
            continue
        each = np.array(
            [
                run.numbers["ego_delay_mean_s"]
                for run in study.runs
                if study.label(run) == label and run.valid and "ego_delay_mean_s" in run.numbers
            ]
        )
        share = 100.0 * row.contacts / row.encounters
        known = mean_interval(each)
        sides = None
        if known is not None:
            sides = [[max(row.delay - known.low, 0.0)], [max(known.high - row.delay, 0.0)]]
        axes.errorbar(
            row.delay,
            share,
            xerr=sides,
            yerr=[[share - 100.0 * row.contact_share.low], [100.0 * row.contact_share.high - share]],
            fmt="o",
            markersize=4.0,
            linewidth=0.7,
        )
        axes.annotate(
            label, (row.delay, share), xytext=(4, 4 + height), textcoords="offset points", fontsize=8
        )
    axes.set_xlabel("delay of a trip [s]")
    axes.set_ylabel("contacts per 100 encounters")
    axes.set_ylim(0.0, None)
    axes.set_xlim(0.0, 1.15 * axes.get_xlim()[1])
    figure.savefig(path, dpi=120, metadata={"Software": None})


def _heights(points: Sequence[tuple[float, float]]) -> list[float]:
    """Return how far above its point each label stands, so that those of near points are apart [points].

    >>> _heights([(9.0, 0.0), (1.0, 0.0), (9.5, 0.0), (9.2, 1.0)])
    [0.0, 0.0, 11.0, 0.0]
    """
    most = max((delay for delay, _ in points), default=0.0)
    levels = [0] * len(points)
    done: list[int] = []
    for i in sorted(range(len(points)), key=lambda i: points[i]):
        near = {
            levels[j]
            for j in done
            if points[i][0] - points[j][0] < WIDTH * most and abs(points[i][1] - points[j][1]) < HEIGHT
        }
        levels[i] = next(level for level in range(len(points)) if level not in near)
        done.append(i)
    return [LINE * level for level in levels]
