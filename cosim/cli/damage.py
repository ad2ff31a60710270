"""What a command says of runs that it has left out because they are damaged."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import typer


def damaged_runs(unreadable: Mapping[Path, str]) -> int:
    """Name the runs that were left out, a line each, and return the exit code."""
    for told in unreadable.values():
        typer.echo(f"cosim: left out: {told}", err=True)
    return 3 if unreadable else 0
