"""``cosim replay``: an encounter as a film."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def replay(
    folder: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="Folder of a recorded run.")],
    encounter: Annotated[int, typer.Option(metavar="N", help="The encounter_id of the encounter.")],
    out: Annotated[
        Path,
        typer.Option("--out", metavar="FILE", help="Film to write: .gif, or .mp4 if ffmpeg is installed."),
    ],
    debug: Debug = False,
) -> int:
    """Write a film of an encounter from above, in real time.

    \b
    Examples:
      cosim replay runs/midblock_zebra-vo_mpc-1-1 --encounter 3 --out encounter-3.gif

    \b
    Exit codes: 0 success, 2 bad input.
    """
    from cosim.presentation.figures import write_replay
    from cosim.presentation.notes import unverified

    for note in unverified([folder] if folder.is_dir() else []):
        terminal.console().print(note, soft_wrap=True)
    count = write_replay(folder, encounter, out)
    terminal.console().print(f"{out}: {count} frames", soft_wrap=True)
    return 0
