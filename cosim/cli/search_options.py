"""Options that ``cosim falsify`` and ``cosim estimate`` share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Searched = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="Scenario's name or folder, or a SUMO configuration.")
]
ControllerName = Annotated[str, typer.Option("--controller", metavar="NAME", help="Controller.")]
Space = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Parameters, their ranges and distributions.",
        show_default="[search] of the scenario, or its crossings",
    ),
]
CriteriaFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="[[criteria]] that count.", show_default="the scenario's"),
]
RunTimeout = Annotated[
    float, typer.Option(metavar="S", min=1, help="Wall-clock time after which a run has failed.")
]
OwnFolder = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Output folder; repeating the command resumes.", show_default="runs/…"
    ),
]
