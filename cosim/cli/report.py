"""``cosim report``: the results of runs as an HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.damage import damaged_runs
from cosim.cli.options import Debug, Xlsx


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR…", help="Folders of runs or studies, or folders that contain run folders."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Folder for report.html.",
            show_default="DIR, or a new one for several",
        ),
    ] = None,
    base: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Controller that others are compared with.",
            show_default="sumo, or the first",
        ),
    ] = None,
    rows: Annotated[
        int, typer.Option(metavar="N", min=1, help="Number of encounters listed, worst first.")
    ] = 200,
    replays: Annotated[int, typer.Option(metavar="N", min=0, help="Number of them with a replay.")] = 100,
    xlsx: Xlsx = False,
    debug: Debug = False,
) -> int:
    """Write report.html: comparison, tables, distributions, the worst encounters and their replays.

    \b
    Examples:
      cosim report results/study
      cosim report runs/midblock_zebra-vo_mpc-1-1
      cosim report runs/midblock_zebra-sumo-1-1 runs/midblock_zebra-aeb-1-1 --out results/two
      cosim report results/study --base aeb --replays 500
      cosim report results/study --xlsx

    \b
    Exit codes: 0 success, 2 no such folder, no run in it, or runs that do not belong together, 3 a run is
    damaged (the others are in the report).
    """
    from cosim.errors import InputError
    from cosim.presentation.page import write_page

    for folder in folders:
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder")
    path, notes, damaged = write_page(folders, out, base, rows, replays)
    console = terminal.console()
    for note in notes:
        console.print(note, soft_wrap=True)
    console.print(f"{path}", soft_wrap=True)
    if xlsx:
        from analysis.page.names import DATA
        from cosim.presentation.workbook import write_workbook

        console.print(f"{write_workbook([*folders, path.parent / DATA], path.parent)}", soft_wrap=True)
    return damaged_runs(damaged)
