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
    from analysis.errors import AnalysisError
    from cosim.errors import InputError
    from cosim.presentation.pictures import check_picture, require_matplotlib

    require_matplotlib("cosim replay")
    from analysis.encounters.case import prepare
    from analysis.plots.animation import FORMATS, has_ffmpeg, write_film
    from analysis.plots.scene import choose
    from analysis.recording.reading import read_run

    check_picture(out, FORMATS)
    if out.suffix.lower() == ".mp4" and not has_ffmpeg():
        raise InputError(f"{out}: .mp4 needs ffmpeg, which is not installed; use .gif instead")
    try:
        count = write_film(choose(prepare(read_run(folder)), None, encounter), out)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"cannot write {out}: {error.strerror or error}") from error
    terminal.console().print(f"{out}: {count} frames", soft_wrap=True)
    return 0
