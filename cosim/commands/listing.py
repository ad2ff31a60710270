"""``cosim list``: what exists."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer
from rich.table import Table

from cosim.commands import terminal
from cosim.commands.options import Debug


class Kind(StrEnum):
    """What can be listed."""

    SCENARIOS = "scenarios"
    CONTROLLERS = "controllers"
    METRICS = "metrics"
    SENSING = "sensing"


def show(
    kind: Annotated[Kind, typer.Argument(help="What to list.", show_choices=True)], debug: Debug = False
) -> int:
    """List scenarios, controllers, metrics or sensing models, with the parameters that --set takes.

    \b
    Examples:
      cosim list scenarios
      cosim list controllers
    """
    from cosim import inventory

    entries = {
        Kind.SCENARIOS: inventory.scenarios,
        Kind.CONTROLLERS: inventory.controllers,
        Kind.METRICS: inventory.metrics,
        Kind.SENSING: inventory.sensing_models,
    }[kind]()
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True, style="bold")
    table.add_column(overflow="fold")
    for entry in entries:
        table.add_row(entry.name, entry.description)
        if entry.parameters:
            table.add_row("", "--set " + "  ".join(entry.parameters), style="dim")
    terminal.console().print(table)
    return 0
