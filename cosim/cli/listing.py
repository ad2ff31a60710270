"""``cosim list``: what is available."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from analysis.errors import did_you_mean
from cosim.cli import names, terminal
from cosim.cli.options import Debug
from cosim.errors import InputError

if TYPE_CHECKING:
    from cosim.running.inventory import Entry

SUITE = "suite:"


class Kind(StrEnum):
    """Kinds of things that can be listed."""

    SCENARIOS = "scenarios"
    CONTROLLERS = "controllers"
    METRICS = "metrics"
    SENSING = "sensing"
    SUITES = "suites"


def _kinds(incomplete: str) -> list[str]:
    return [kind for kind in (*Kind, *names.suites()) if kind.startswith(incomplete)]


def show(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="|".join(Kind),
            help="What to list, or suite:NAME for the cases of a suite.",
            show_default="the names of everything",
            autocompletion=_kinds,
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="A controller or a sensing model: a table of its parameters."),
    ] = None,
    debug: Debug = False,
) -> int:
    """List scenarios, controllers, metrics, sensing models or suites, and their parameters for --set.

    \b
    Examples:
      cosim list
      cosim list scenarios
      cosim list controllers
      cosim list controllers vo_mpc
      cosim list suite:fmvss127
    """
    if what is None:
        return _print_names()
    if name is not None:
        return _print_parameters(what, name)
    for entry_kind in Kind:
        if what == entry_kind:
            return _print(_entries(entry_kind))
    if what.startswith(SUITE):
        from cosim.suites import listing

        return _print(listing.cases(what))
    hint = did_you_mean(what, (str(kind) for kind in Kind))
    raise InputError(f"list {what}: {hint}expected one of {', '.join(Kind)}, or {SUITE}NAME")


def _print_names() -> int:
    """Print what there is, and how to see more of it."""
    from textwrap import fill

    known = {
        Kind.SCENARIOS: names.scenarios(),
        Kind.CONTROLLERS: names.controllers(),
        Kind.SENSING: names.sensing_models(),
        Kind.SUITES: names.suites(),
        Kind.METRICS: names.metrics(),
    }
    for kind, listed in known.items():
        typer.echo(fill(", ".join(listed), 100, initial_indent=f"{kind:12}", subsequent_indent=" " * 12))
    typer.echo("\nwith descriptions and parameters: cosim list scenarios, cosim list controllers, …")
    return 0


def _entries(kind: Kind) -> Sequence[Entry]:
    from cosim.running import inventory
    from cosim.suites import listing

    return {
        Kind.SCENARIOS: inventory.scenarios,
        Kind.CONTROLLERS: inventory.controllers,
        Kind.METRICS: inventory.metrics,
        Kind.SENSING: inventory.sensing_models,
        Kind.SUITES: listing.suites,
    }[kind]()


def _print_parameters(what: str, name: str) -> int:
    from cosim.running import inventory

    described = {
        Kind.CONTROLLERS: inventory.described_controller,
        Kind.SENSING: inventory.described_sensing,
    }
    if what not in described:
        raise InputError(f"list {what} {name}: a name follows {' or '.join(described)} only")
    from rich.table import Table

    parameters = described[Kind(what)](name)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("parameter", "default", "unit"):
        table.add_column(title, no_wrap=True)
    for title in ("bounds", "meaning"):
        table.add_column(title, overflow="fold")
    for one in parameters:
        table.add_row(one.name, inventory.as_text(one.default), one.unit, one.bounds, one.meaning)
    terminal.console().print(table if parameters else f"{name} has no parameters")
    return 0


def _print(entries: Sequence[Entry]) -> int:
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True, style="bold")
    table.add_column(overflow="fold")
    for entry in entries:
        table.add_row(entry.name, entry.description)
        if entry.parameters:
            table.add_row("", "--set " + "  ".join(entry.parameters), style="dim")
    terminal.console().print(table)
    return 0
