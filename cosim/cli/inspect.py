"""``cosim inspect``: does a network support a pedestrian study?"""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug

if TYPE_CHECKING:
    from rich.table import Table

    from cosim.inspection.inspection import Inspection


def inspect(
    path: Annotated[
        Path, typer.Argument(metavar="NET_OR_SUMOCFG", help="SUMO network or SUMO configuration.")
    ],
    scaffold: Annotated[
        Path | None,
        typer.Option("--scaffold", metavar="DIR", help="Write a scenario folder for cosim run."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Draw a map with the crossings (.png or .svg)."),
    ] = None,
    debug: Debug = False,
) -> int:
    """Check whether a network supports a pedestrian study, and print the commands that fix it.

    \b
    Examples:
      cosim inspect town.net.xml
      cosim inspect town.sumocfg --picture town.png
      cosim inspect town.sumocfg --scaffold scenarios/town

    \b
    Exit codes: 0 it does, 1 it does not yet, 2 bad input.
    """
    from cosim.inspection.inspection import inspect as look
    from cosim.inspection.scaffold import write_scaffold
    from cosim.recording import folders

    folders.check(scaffold, "--scaffold")
    found = look(path)
    if picture is not None:
        from cosim.presentation.pictures import check_picture, require_matplotlib

        require_matplotlib("--picture")
        check_picture(picture)
    console = terminal.console()
    console.print(_findings(found))
    if found.counts:
        console.print()
        console.print(_crossings(found))
    _show_routes(found)
    for command in dict.fromkeys(finding.command for finding in found.findings if finding.command):
        checks = ", ".join(finding.check for finding in found.findings if finding.command == command)
        console.print(f"\nto fix {checks}:\n  {command}", soft_wrap=True)
    console.print(f"\n{path}: {found.verdict}", soft_wrap=True)
    if picture is not None:
        from cosim.inspection.picture import draw_map

        draw_map(found, picture)
        console.print(f"map: {picture}", soft_wrap=True)
    if scaffold is not None:
        for line in write_scaffold(found, scaffold):
            console.print(line, soft_wrap=True)
        console.print(
            f"scenario: {scaffold}; to run it: cosim run {shlex.quote(str(scaffold))}", soft_wrap=True
        )
    return 0 if found.possible else 1


def _findings(found: Inspection) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD)
    for name in ("check", "", "found"):
        table.add_column(name, overflow="fold")
    for finding in found.findings:
        table.add_row(finding.check, finding.level.value, finding.text)
    return table


def _crossings(found: Inspection) -> Table:
    from rich import box
    from rich.table import Table

    from cosim.inspection.crossings import NAMES

    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("crossings")
    for name in ("lanes for cars", "number"):
        table.add_column(name, justify="right")
    for (kind, lanes), count in found.counts.items():
        table.add_row(NAMES[kind], str(lanes), str(count))
    return table


def _show_routes(found: Inspection) -> None:
    if not found.routes:
        return
    console = terminal.console()
    console.print("\nego routes that pass a crossing:", soft_wrap=True)
    for route in found.routes:
        text = f'  --ego-route "{" ".join(route.edges)}"  {len(route.crossings)} on {route.length_m:.0f} m'
        console.print(text, soft_wrap=True)
