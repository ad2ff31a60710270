"""``cosim plot``: figures of a recorded run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def plot(
    folder: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="Folder of a recorded run.")],
    ego: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Ego whose trip is drawn.", show_default="the first ego"),
    ] = None,
    encounter: Annotated[
        int | None, typer.Option(metavar="N", help="Draw only the encounter with this encounter_id.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Empty or new folder for the figures.", show_default="RUN_DIR/plots"
        ),
    ] = None,
    kind: Annotated[str, typer.Option("--format", metavar="png|svg", help="File format.")] = "png",
    debug: Debug = False,
) -> int:
    """Draw the trip of an ego or one encounter: on the map, over time, and as a space-time diagram.

    \b
    Examples:
      cosim plot runs/midblock_zebra-vo_mpc-1-1
      cosim plot runs/midblock_zebra-vo_mpc-1-1 --encounter 3 --format svg --out figures

    \b
    Exit codes: 0 success, 2 bad input.
    """
    from cosim.presentation.figures import write_figures
    from cosim.presentation.notes import unverified

    for note in unverified([folder] if folder.is_dir() else []):
        terminal.console().print(note, soft_wrap=True)
    for file in write_figures(folder, ego, encounter, out, kind):
        terminal.console().print(str(file), soft_wrap=True)
    return 0
