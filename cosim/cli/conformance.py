"""``cosim conformance``: checks the coupling with the installed SUMO, or a controller."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug, Settings


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
    controller: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Check this controller, not the coupling.", show_default=False),
    ] = None,
    settings: Settings = None,
    debug: Debug = False,
) -> int:
    """Check the coupling against the installed SUMO, or a controller against what every one promises.

    Every case of the coupling has a control that must fail.

    \b
    Examples:
      cosim conformance
      cosim conformance --jobs 2
      cosim conformance --out conformance.md
      cosim conformance --list
      cosim conformance --controller vo_mpc
      cosim conformance --controller ./patient.py --set margin_m=1

    \b
    Exit codes: 0 all as expected, 1 a case or a control is not as expected or a promise is broken,
    2 unknown case or controller.
    """
    from cosim.errors import InputError

    if controller is not None:
        if only_list:
            raise InputError("--list lists the cases of the coupling: expected no --controller")
        return _check_controller(controller, settings or [], names or [], out)
    if settings:
        raise InputError(f"--set {settings[0]} belongs to a controller: expected --controller, too")
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
        _check_writable(out)
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


def _check_controller(name: str, settings: list[str], cases: list[str], out: Path | None) -> int:
    """Print what a controller keeps of the contract, and return the exit code."""
    from rich.table import Table

    from analysis.markdown import table as markdown_table
    from cosim.conformance.contract_table import HEADINGS, verdicts
    from cosim.errors import InputError
    from cosim.running.inventory import controller_maker
    from cosim.running.request import parse_settings

    if cases:
        raise InputError(f"{cases[0]}: --controller takes no case; every check is run")
    factory = controller_maker(name, parse_settings(settings, "deadline_ms=50"))
    if out is not None:
        _check_writable(out)
    table = Table(title=f"What {name} keeps of what every controller promises", title_justify="left")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    found = []
    for one in verdicts(factory):
        found.append(one)
        table.add_row(*one.row())
    console = terminal.console()
    console.print(table)
    broken = [one.name for one in found if not one.kept]
    said = f"{len(found) - len(broken)} of {len(found)} promises kept"
    said += f"; broken: {', '.join(broken)}" if broken else ""
    console.print(said, soft_wrap=True)
    if out is not None:
        _write(out, f"{said}.\n\n{markdown_table(HEADINGS, [one.row() for one in found])}\n")
        console.print(f"\ntable: {out}", soft_wrap=True)
    return 1 if broken else 0


def _check_writable(path: Path) -> None:
    """Refuse now, not after minutes, what cannot be written; a table that is there stays for now."""
    with _told(path), path.open("a", encoding="utf-8"):
        pass


def _write(path: Path, text: str) -> None:
    from analysis.files import write_text

    with _told(path):
        write_text(path, text)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    from cosim.errors import InputError

    try:
        yield
    except OSError as error:
        raise InputError(f"--out {path}: cannot be written: {error.strerror}") from error
