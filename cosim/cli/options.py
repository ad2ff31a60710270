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
Xlsx = Annotated[
    bool, typer.Option("--xlsx", help="Also write the tables as tables.xlsx, with units and definitions.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Set a scenario, controller or sensing parameter; repeatable."
    ),
]

Jobs = Annotated[
    int | None,
    typer.Option(metavar="N", min=1, help="Number of parallel runs.", show_default="one per core"),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Run on the Dask cluster with this scheduler."),
]

NetworkFile = Annotated[
    Path | None,
    typer.Option(
        "--network", metavar="NET", help="Judge tracks on this network, or that of a SUMO configuration."
    ),
]
Tracks = Annotated[
    str,
    typer.Option(
        "--tracks",
        metavar="FILE",
        help="Tracks of real road users; tasi: those of DLR Urban Traffic in that package.",
    ),
]
Crs = Annotated[
    str | None,
    typer.Option(
        "--crs",
        metavar="EPSG:N",
        help="Coordinate system of the tracks' positions.",
        show_default="as the layout says, or the network's own",
    ),
]
Bodies = Annotated[
    str | None,
    typer.Option(
        "--bodies",
        metavar="assumed|recorded",
        help="Lengths and widths of vehicles in tracks.",
        show_default="recorded where reliable",
    ),
]


def here_or_elsewhere(jobs: int | None, scheduler: str | None) -> None:
    """Refuse both of two places for runs.

    Raises
    ------
    InputError
        If both are given.
    """
    from cosim.errors import InputError

    if jobs is not None and scheduler is not None:
        raise InputError("use either --jobs or --scheduler; a cluster has its own number of workers")
