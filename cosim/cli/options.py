"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Output folder, new or empty.", show_default="runs/…"),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Set a scenario, controller or sensing parameter; repeatable."
    ),
]
