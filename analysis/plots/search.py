"""Figures of a search: where runs failed and where they passed, and the progress."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from analysis.search.axes import Axis
from analysis.search.results import FAIL, INVALID, PASS, UNDEFINED, UNPREVENTABLE, Tried
from analysis.search.sensitivity import Influence

WIDTH_IN, HEIGHT_IN = 6.4, 4.4
STYLES = {
    PASS: ("o", "#0072b2", "passed"),
    UNDEFINED: ("o", "#9aa3ad", "nothing to judge"),
    UNPREVENTABLE: ("^", "#9a6f00", "failed, nobody could have prevented it"),
    FAIL: ("X", "#d55e00", "preventable failure"),
}


def draw_boundary(axes: Sequence[Axis], tried: Sequence[Tried]) -> Figure:
    """Draw the runs over two axes.

    Parameters
    ----------
    axes
        Two axes; choices are drawn side by side.
    tried
    """
    figure = Figure((WIDTH_IN, HEIGHT_IN), layout="constrained")
    plot = figure.add_subplot()
    across, up = axes
    for status, (marker, colour, label) in STYLES.items():
        some = [one for one in tried if one.status == status]
        if not some:
            continue
        size = 46 if status == FAIL else 20
        plot.scatter(
            _places(across, some),
            _places(up, some),
            s=size,
            c=colour,
            marker=marker,
            label=f"{label} ({len(some)})",
            zorder=2 + (status == FAIL),
            linewidths=0.0,
        )
    _name_choices(plot, across, up)
    plot.set_xlabel(across.name)
    plot.set_ylabel(up.name)
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def draw_progress(tried: Sequence[Tried]) -> Figure:
    """Draw the smallest margin so far and the number of preventable failures over the runs."""
    figure = Figure((WIDTH_IN, HEIGHT_IN), layout="constrained")
    plot = figure.add_subplot()
    margins = [1.0 if one.verdict.margin is None else one.verdict.margin for one in tried]
    runs = np.arange(1, len(tried) + 1)
    known = [one.status != INVALID for one in tried]
    plot.scatter(runs[known], np.array(margins)[known], s=9, c="#9aa3ad", label="margin of each run")
    plot.step(runs, np.minimum.accumulate(margins), where="post", color="#0072b2", label="smallest so far")
    plot.axhline(0.0, color="#1b2330", linewidth=0.8)
    plot.set_xlabel("run")
    plot.set_ylabel("margin")
    count = plot.twinx()
    failures = np.cumsum([one.status == FAIL for one in tried])
    count.step(runs, failures, where="post", color="#d55e00", label="preventable failures (right)")
    count.set_ylim(0, max(1, int(failures[-1])) * 1.1)
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return figure


def most_deciding(axes: Sequence[Axis], influences: Sequence[Influence]) -> list[Axis]:
    """Return the two axes with the most influence; without influences, numeric axes come first."""
    by_name = {axis.name: axis for axis in axes}
    order = [by_name[one.axis] for one in influences] or sorted(axes, key=lambda axis: not axis.numeric)
    return order[:2]


def _places(axis: Axis, tried: Sequence[Tried]) -> list[float]:
    if axis.numeric:
        return [float(one.point[axis.name]) for one in tried]
    # Shifted by the number of the trial, so that points of one choice do not hide each other.
    return [
        axis.choices.index(str(one.point[axis.name])) + 0.5 * ((one.number * 0.618) % 1.0 - 0.5)
        for one in tried
    ]


def _name_choices(plot: object, across: Axis, up: Axis) -> None:
    for axis, name in ((across, "x"), (up, "y")):
        if not axis.numeric:
            getattr(plot, f"set_{name}ticks")(range(len(axis.choices)), axis.choices)
