"""``cosim compare``: is one controller safer than another, and slower?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.damage import damaged_runs
from cosim.cli.options import Debug


def compare(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder of a study, or any folder that contains run folders."),
    ],
    alt: Annotated[
        str, typer.Option(metavar="NAME", help="Controller to compare, optionally with parameters.")
    ],
    base: Annotated[str, typer.Option(metavar="NAME", help="Controller to compare it with.")] = "sumo",
    metrics: Annotated[
        list[str] | None,
        typer.Option(
            "--metric",
            metavar="NAME",
            help="Measure to compare; repeatable.",
            show_default="the key measures",
        ),
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only this scenario.", show_default="all")
    ] = None,
    each: Annotated[
        bool, typer.Option("--each", help="One table per setting of a scenario instead of one for all.")
    ] = False,
    write: Annotated[
        bool, typer.Option("--write", help="Also write the rows to DIR/comparison-BASE-ALT.csv.")
    ] = False,
    debug: Debug = False,
) -> int:
    """Compare two controllers on the same seeds: is one safer, and is it slower?

    \b
    Examples:
      cosim compare results/study --base sumo --alt vo_mpc
      cosim compare runs --base sumo --alt aeb --metric ego_delay_mean_s --metric n_lane_changes
      cosim compare results/study --alt "vo_mpc steps=20" --each --write

    \b
    Exit codes: 0 success, 2 no such folder, controller, measure or scenario, or no seed in common, 3 a run
    is damaged (the others are compared).
    """
    from cosim.presentation.comparison import CompareRequest, compare_runs
    from cosim.presentation.notes import unverified
    from cosim.presentation.wording import notes, sentence, table

    found = compare_runs(CompareRequest(folder, alt, base, tuple(metrics or ()), scenario, each))
    console = terminal.console()
    for number, one in enumerate(found.tables):
        if number:
            console.print()
        console.print(sentence(one.rows, found.measures) + "\n", soft_wrap=True)
        console.print(table(one.rows, found.measures))
        console.print("\n" + "\n".join(notes(one.rows, one.pairs, one.runs)), soft_wrap=True)
    if found.left_out:
        names = ", ".join(f"{where.scenario_id} {where.text}".strip() for where in found.left_out)
        console.print(f"Left out, because no seed in common has valid runs: {names}.", soft_wrap=True)
    if write:
        console.print(f"file: {found.write()}", soft_wrap=True)
    for note in unverified(run.folder for run in found.study.runs if run.valid):
        console.print(note, soft_wrap=True)
    return damaged_runs(found.study.unreadable)
