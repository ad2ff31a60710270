"""``cosim report``: the results of runs as an HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR…", help="Folders of runs or studies, or folders that contain run folders."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Folder for report.html.",
            show_default="DIR, or a new one for several",
        ),
    ] = None,
    base: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Controller that others are compared with.",
            show_default="sumo, or the first",
        ),
    ] = None,
    rows: Annotated[
        int, typer.Option(metavar="N", min=1, help="Number of encounters listed, worst first.")
    ] = 200,
    replays: Annotated[int, typer.Option(metavar="N", min=0, help="Number of them with a replay.")] = 100,
    debug: Debug = False,
) -> int:
    """Write report.html: comparison, tables, distributions, the worst encounters and their replays.

    \b
    Examples:
      cosim report results/study
      cosim report runs/midblock_zebra-vo_mpc-1-1
      cosim report runs/midblock_zebra-sumo-1-1 runs/midblock_zebra-aeb-1-1 --out results/two
      cosim report results/study --base aeb --replays 500

    \b
    Exit codes: 0 success, 2 no such folder, no run in it, or runs that do not belong together.
    """
    from cosim.errors import InputError

    for folder in folders:
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder")
    path, notes = write(folders, out, base, rows, replays)
    console = terminal.console()
    for note in notes:
        console.print(note, soft_wrap=True)
    console.print(f"{path}", soft_wrap=True)
    return 0


def write(
    folders: list[Path],
    out: Path | None = None,
    base: str | None = None,
    rows: int = 200,
    replays: int = 100,
) -> tuple[Path, list[str]]:
    """Write the page; return its path and notes to print.

    Raises
    ------
    InputError
        If the runs cannot be read, the page cannot be written, or a required package is missing.
    """
    try:
        from analysis.page.report import write_report
    except ModuleNotFoundError as error:
        raise unavailable(error) from error
    from analysis.errors import AnalysisError
    from cosim.errors import InputError
    from cosim.presentation.wording import sentence
    from cosim.recording.folders import create_named

    if out is None:
        out = folders[0] if len(folders) == 1 else create_named(None, "report")
    title = out.resolve().name if len(folders) == 1 else ", ".join(folder.name for folder in folders)
    try:
        written = write_report(folders, out, sentence, title=title, baseline=base, rows=rows, replays=replays)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{out}: the report cannot be written: {error.strerror}") from error
    notes = [f"{written.listed} encounters listed, {written.replays} with a replay"]
    if written.not_recorded:
        notes.append(
            f"{written.not_recorded} of them have no recording to replay; "
            "the page gives the command that records each"
        )
    return written.page, notes


def unavailable(error: ModuleNotFoundError) -> Exception:
    """Return an error that says which extra to install."""
    from cosim.errors import InputError

    return InputError(f'{error.name} is not installed; run: pip install "sumo-cosim[report]"')
