"""``cosim conformance``: what is true of the coupling with the SUMO that is installed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import typer
from rich.table import Table

from cosim.commands import terminal
from cosim.commands.options import Debug


def conformance(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[CASE]…", help="Cases to run.", show_default="all")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes at a time.")] = 1,
    only_list: Annotated[bool, typer.Option("--list", help="Say which cases exist, run none.")] = False,
    debug: Debug = False,
) -> int:
    """Check the coupling against the installed SUMO; every case has a control that must fail.

    \b
    Examples:
      cosim conformance
      cosim conformance --jobs 2
      cosim conformance --list

    \b
    Exit codes: 0 all as expected, 1 a case or a control is not, 2 unknown case.
    """
    from cosim.conformance import suite
    from cosim.provenance import versions

    console = terminal.console()
    chosen = suite.named(names) if names else suite.cases()
    if only_list:
        table = Table(box=None, show_header=False, pad_edge=False)
        for case in chosen:
            table.add_row(case.key, case.name)
        console.print(table)
        return 0
    results = suite.run(chosen, jobs, lambda result: typer.echo(f"{result.case.key} done", err=True))
    table = Table(title=f"Conformance with SUMO {versions().get('libsumo', '?')}", title_justify="left")
    for heading in ("case", "claim", "expected", "measured", "control", "verdict"):
        table.add_column(heading, overflow="fold")
    for result in results:
        case = result.case
        table.add_row(
            case.key,
            case.name,
            case.expected,
            _values(result.measured),
            _values(result.control_measured),
            result.verdict,
        )
    console.print(table)
    failed = [result.case.key for result in results if not result.green]
    if failed:
        typer.echo(f"cosim: not as expected: {', '.join(failed)}", err=True)
    green = len(results) - len(failed)
    console.print(f"{green} of {len(results)} as expected, controls included")
    return 1 if failed else 0


def _values(values: Mapping[str, float | str]) -> str:
    shown = {key: value for key, value in values.items() if key != "return_code" or value != 0}
    return ", ".join(
        f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in shown.items()
    )
