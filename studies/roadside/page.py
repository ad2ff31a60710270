"""``python -m studies.roadside.page STUDY PAGE``: write tables and figure of the runs of a study.

The tables go below the line ``## Tables`` of the page, whose text above this line is kept, and the figure
beside the page.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analysis.errors import StudyError
from analysis.markdown import table, write_below
from analysis.statistics.intervals import share_interval
from analysis.study.runs import read_runs
from studies.finished import run_folders
from studies.roadside.cells import Cell, against, cells
from studies.roadside.figure import draw

TABLES = "## Tables"
BASE = ("onboard", None)
"""Baseline of the comparisons: a car that has only its own sensor."""
_HEADS = (
    "sensing",
    "latency [ms]",
    "valid runs",
    "entered encounters",
    "contacts",
    "share (95 %)",
    "contacts, preventable",
    "told before the conflict [s]",
    "delay of a trip [s]",
    "contacts per encounter, against onboard",
    "delay, against onboard [s]",
)


def markdown(found: Sequence[Cell]) -> str:
    """Return one table for each driver and each kind of obstacle."""
    blocks = []
    for hidden_by, driver in dict.fromkeys((cell.hidden_by, cell.driver) for cell in found):
        mine = [cell for cell in found if (cell.hidden_by, cell.driver) == (hidden_by, driver)]
        base = next((cell for cell in mine if cell.seeing == BASE), None)
        rows = table(_HEADS, [_texts(cell, base) for cell in mine])
        blocks.append(f"### Hidden by {hidden_by}: {driver}\n\n{rows}\n")
    return "\n".join(blocks)


def write_page(folder: Path, page: Path) -> None:
    """Write tables and figure of a study's folder.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or they cannot be read.
    """
    found = cells(read_runs(run_folders(folder)))
    figure = page.with_suffix(".svg")
    draw(found, figure)
    text = f"![Contacts and delay over latency]({figure.name})\n\n{markdown(found)}"
    write_below(page, TABLES, text, "# Roadside")


def _texts(cell: Cell, base: Cell | None) -> list[str]:
    model, latency = cell.seeing
    share = share_interval(cell.contacts, cell.encounters)
    told = np.concatenate([one.told for one in cell.outcomes]) if cell.outcomes else np.zeros(0)
    return [
        model,
        "" if latency is None else f"{latency:g}",
        f"{len(cell.outcomes)} of {cell.runs}",
        str(cell.encounters),
        f"**{cell.contacts}**",
        f"{cell.contacts / cell.encounters:.0%} ({share.low:.0%} … {share.high:.0%})" if share else "",
        str(sum(one.preventable for one in cell.outcomes)),
        f"{told.mean():.1f}" if len(told) else "",
        "" if cell.delay is None else f"{cell.delay:.1f}",
        against(cell, base, "contacts"),
        against(cell, base, "delay"),
    ]


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"roadside: {problem}")
