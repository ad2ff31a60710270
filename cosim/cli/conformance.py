"""``cosim conformance``: checks the coupling with the installed SUMO."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def conformance(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[CASE]…", help="Cases to run.", show_default="all")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Number of parallel processes.")] = 1,
    only_list: Annotated[bool, typer.Option("--list", help="List the cases without running them.")] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Also write the table as Markdown.", show_default=False),
    ] = None,
    debug: Debug = False,
) -> int:
    """Check the coupling against the installed SUMO; every case has a control that must fail.

    \b
    Examples:
      cosim conformance
      cosim conformance --jobs 2
      cosim conformance --out conformance.md
      cosim conformance --list

    \b
    Exit codes: 0 all as expected, 1 a case or a control is not as expected, 2 unknown case.
    """
    from cosim.conformance import suite
    from cosim.conformance.table import HEADINGS, markdown, summary, sumo_version, table_rows

    console = terminal.console()
    chosen = suite.named(names) if names else suite.cases()
    from rich.table import Table

    if only_list:
        table = Table(box=None, show_header=False, pad_edge=False)
        for case in chosen:
            table.add_row(case.key, case.name)
        console.print(table)
        return 0
    if out is not None:
        _write(out, "")  # fail now if it is not writable, not after minutes
    results = suite.run(chosen, jobs, lambda result: typer.echo(f"{result.case.key} done", err=True))
    table = Table(title=f"Conformance with SUMO {sumo_version()}", title_justify="left")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    for row in table_rows(results):
        table.add_row(*row)
    console.print(table)
    console.print(summary(results), soft_wrap=True)
    if out is not None:
        _write(out, markdown(results))
        console.print(f"\ntable: {out}", soft_wrap=True)
    return 0 if all(result.green for result in results) else 1


def _write(path: Path, text: str) -> None:
    from cosim.errors import InputError

    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise InputError(f"--out {path}: cannot be written: {error.strerror}") from error
