"""The figure of the page: contacts and delay over the latency of the radio."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from analysis.statistics.intervals import share_interval
from studies.roadside.cells import ORDER, Cell

COLOURS = {"perfect": "#777777", "onboard": "#D55E00", "roadside": "#0072B2", "fused": "#009E73"}


def draw(found: Sequence[Cell], path: Path) -> None:
    """Draw contacts and delay over latency, with two rows of axes for each kind of obstacle."""
    rows = list(dict.fromkeys(cell.hidden_by for cell in found))
    drivers = list(dict.fromkeys(cell.driver for cell in found))
    figure = Figure(figsize=(3.4 * len(drivers), 4.2 * len(rows)), layout="constrained")
    grid = figure.subplots(2 * len(rows), len(drivers), sharex=True, sharey="row", squeeze=False)
    for row, hidden_by in enumerate(rows):
        for column, driver in enumerate(drivers):
            share, delay = grid[2 * row, column], grid[2 * row + 1, column]
            share.set_title(f"{driver}\nhidden by {hidden_by}", loc="left", fontsize=8)
            for model in ORDER:
                mine = [
                    cell
                    for cell in found
                    if (cell.hidden_by, cell.driver, cell.seeing[0]) == (hidden_by, driver, model)
                    and cell.encounters
                ]
                if not mine:
                    continue
                latency = [cell.seeing[1] for cell in mine]
                level = [cell.contacts / cell.encounters for cell in mine]
                late = [cell.delay for cell in mine]
                if latency == [None]:
                    share.axhline(level[0], color=COLOURS[model], linestyle="--", label=model)
                    delay.axhline(late[0], color=COLOURS[model], linestyle="--")
                    continue
                ends = [share_interval(cell.contacts, cell.encounters) for cell in mine]
                below = [one - end.low if end else 0.0 for one, end in zip(level, ends, strict=True)]
                above = [end.high - one if end else 0.0 for one, end in zip(level, ends, strict=True)]
                share.errorbar(
                    latency, level, [below, above], color=COLOURS[model], marker="o", capsize=2, label=model
                )
                delay.plot(latency, late, color=COLOURS[model], marker="o")
            delay.set_xlabel("latency_ms")
        grid[2 * row, 0].set_ylabel("contacts per encounter")
        grid[2 * row + 1, 0].set_ylabel("ego_delay_mean_s")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    with matplotlib.rc_context({"svg.hashsalt": "cosim"}):
        figure.savefig(path, metadata={"Date": None})
