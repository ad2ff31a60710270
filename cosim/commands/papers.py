"""``cosim papers``: the experiments of the papers, and what became of their claims."""

from __future__ import annotations

from typing import Annotated

import typer

from cosim.commands import terminal
from cosim.commands.options import Debug, Out


def papers(
    numbers: Annotated[
        list[str] | None,
        typer.Argument(metavar="[PAPER]…", help="Numbers of papers.", show_default="all"),
    ] = None,
    out: Out = None,
    debug: Debug = False,
) -> int:
    """Run the experiments of the papers and say which of their claims are reproduced.

    Writes claims.csv, one row per claim, and the figures. Simulates without SUMO.

    \b
    Examples:
      cosim papers
      cosim papers 000 004 --out results/papers

    \b
    Exit codes: 0 the experiments ran, whatever became of the claims; 2 unknown paper, a folder that is not
    empty, or a package that is missing.
    """
    from cosim import output
    from cosim.commands.interruption import termination_interrupts
    from cosim.papers import execution, experiments, table

    chosen = experiments.chosen(numbers or [])
    folder = output.create_named(out, "papers")

    def finished(one: experiments.Experiment, seconds: float) -> None:
        typer.echo(f"{one.paper} done after {seconds:.0f} s", err=True)

    with termination_interrupts():
        claims = execution.execute(chosen, folder, finished)
    console = terminal.console()
    console.print(table.counts(claims, {one.paper: one.title for one in chosen}))
    missed = table.not_reproduced(claims)
    if missed.row_count:
        console.print()
        console.print(missed)
    console.print(f"\nfiles: {folder}", soft_wrap=True)
    return 0
