"""``cosim list``: what is available."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from cosim.cli import terminal
from cosim.cli.options import Debug
from cosim.errors import InputError

if TYPE_CHECKING:
    from cosim.running.inventory import Entry

SUITE = "suite:"


class Kind(StrEnum):
    """What can be listed."""

    SCENARIOS = "scenarios"
    CONTROLLERS = "controllers"
    METRICS = "metrics"
    SENSING = "sensing"
    SUITES = "suites"


def show(
    what: Annotated[
        str,
        typer.Argument(metavar="|".join(Kind), help="What to list, or suite:NAME for the cases of a suite."),
    ],
    debug: Debug = False,
) -> int:
    """List scenarios, controllers, metrics, sensing models or suites, and their parameters for --set.

    \b
    Examples:
      cosim list scenarios
      cosim list controllers
      cosim list suite:fmvss127
    """
    for entry_kind in Kind:
        if what == entry_kind:
            return _print(_entries(entry_kind))
    if what.startswith(SUITE):
        from cosim.suites import listing

        return _print(listing.cases(what))
    near = get_close_matches(what, list(Kind), n=1)
    hint = f"did you mean '{near[0]}'? " if near else ""
    raise InputError(f"list {what}: {hint}expected one of {', '.join(Kind)}, or {SUITE}NAME")


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


def _print(entries: Sequence[Entry]) -> int:
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True, style="bold")
    table.add_column(overflow="fold")
    for entry in entries:
        table.add_row(entry.name, entry.description)
        if entry.parameters:
            table.add_row("", "--set " + "  ".join(entry.parameters), style="dim")
    terminal.console().print(table)
    return 0
