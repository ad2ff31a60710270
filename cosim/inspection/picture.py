"""Draws a map of the network: roads, sidewalks, crossings by kind, and the suggested routes."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from analysis.plots.saving import save
from controllers.interface import CrossingKind
from cosim.inspection.crossings import NAMES
from cosim.inspection.inspection import Inspection
from cosim.inspection.roads import is_sidewalk
from cosim.sumo.network import NetLane, Network

# Colours of Okabe and Ito, which colour-blind readers can tell apart; the markers show the kind, too.
MARKS: Final = {
    CrossingKind.ZEBRA: ("#0072B2", "o"),
    CrossingKind.UNMARKED: ("#D55E00", "^"),
    CrossingKind.SIGNAL: ("#009E73", "s"),
}
ROUTE: Final = "#CC79A7"
ROAD: Final = "#9a9a9a"
WALK: Final = "#d9cfae"
WIDTH_IN: Final = 9.0


def draw_map(found: Inspection, path: Path) -> None:
    """Draw the map into a PNG or SVG file; the same network gives the same bytes."""
    network = found.network
    lanes = list(network.lanes.values())
    points = np.concatenate([lane.shape for lane in lanes])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.03 * float(max(high - low)) + 5.0
    wide, tall = (high - low) + 2.0 * margin
    height = float(np.clip(WIDTH_IN * tall / wide, 3.0, 12.0)) + 0.9
    figure = Figure(figsize=(WIDTH_IN, height), layout="constrained")
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    _lanes(axes, [lane for lane in lanes if not is_sidewalk(lane)], ROAD, "road")
    _lanes(axes, [lane for lane in lanes if is_sidewalk(lane)], WALK, "sidewalk")
    for number, route in enumerate(found.routes):
        _route(axes, network, route.edges, "suggested ego route" if number == 0 else "")
    for kind in CrossingKind:
        _crossings(axes, network, kind)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_title(f"{found.source.path.name}: {found.verdict}", fontsize=9)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    save(figure, path)


def _lanes(axes: Axes, lanes: Iterable[NetLane], color: str, label: str) -> None:
    shapes = [lane.shape for lane in lanes]
    if shapes:
        axes.add_collection(LineCollection(shapes, colors=color, linewidths=1.0, label=label, zorder=1))


def _route(axes: Axes, network: Network, edges: Iterable[str], label: str) -> None:
    lanes = [network.lanes[network.edges[edge][-1]] for edge in edges]
    line = np.concatenate([lane.shape for lane in lanes])
    axes.plot(*line.T, color=ROUTE, linewidth=2.5, alpha=0.7, label=label or "_", zorder=2)


def _crossings(axes: Axes, network: Network, kind: CrossingKind) -> None:
    found = [one for one in network.crossings.values() if one.kind is kind]
    if not found:
        return
    color, marker = MARKS[kind]
    axes.add_collection(LineCollection([one.axis for one in found], colors=color, linewidths=2.5, zorder=3))
    middles = np.array([0.5 * (one.axis[0] + one.axis[-1]) for one in found])
    label = f"crossings: {NAMES[kind]} ({len(found)})"
    axes.plot(*middles.T, marker, color=color, markersize=5.0, linestyle="none", label=label, zorder=4)
