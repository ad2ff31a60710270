"""``cosim verify``: are the files of finished runs as they were written?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def verify(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", help="Folder of a run, a study or a check, or any that contains run folders."
        ),
    ],
    debug: Debug = False,
) -> int:
    """Check that no file of a finished run was altered or lost; name each that was, and what can be done.

    \b
    Examples:
      cosim verify runs/midblock_zebra-vo_mpc-1-1
      cosim verify results/study

    \b
    Exit codes: 0 every file is as it was written, 2 no such folder or no run in it, 3 a file was altered
    or lost.
    """
    from cosim.batches.integrity import verify_folder

    found = verify_folder(folder)
    for told in found.damages:
        typer.echo(f"cosim: {told}", err=True)
    console = terminal.console()
    for note in found.notes:
        console.print(note, soft_wrap=True)
    console.print(f"{found.runs} runs verified, {len(found.damages)} files damaged", soft_wrap=True)
    return 3 if found.damages else 0
