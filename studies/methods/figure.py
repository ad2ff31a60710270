"""Safety against delay: one point a method, with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from analysis.statistics.intervals import mean_interval
from analysis.study.design import Study
from studies.methods.rows import Row


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
    for label, row in rows.items():
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
        axes.annotate(label, (row.delay, share), xytext=(4, 4), textcoords="offset points", fontsize=8)
    axes.set_xlabel("delay of a trip [s]")
    axes.set_ylabel("contacts per 100 encounters")
    axes.set_ylim(0.0, None)
    axes.set_xlim(0.0, None)
    figure.savefig(path, dpi=120, metadata={"Software": None})
