"""``cosim analyse``: recompute the CSV files from recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug


def analyse(
    folders: Annotated[list[Path], typer.Argument(metavar="RUN_DIR…", help="Folders of recorded runs.")],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Threshold of the analysis; repeatable."),
    ] = None,
    ssam: Annotated[
        bool, typer.Option("--ssam", help="Also write run.trj in SSAM's format and ssam_id_map.csv.")
    ] = False,
    debug: Debug = False,
) -> int:
    """Recompute encounters.csv and runs.csv from recorded runs, without simulating.

    \b
    Examples:
      cosim analyse runs/midblock_zebra-vo_mpc-1-1
      cosim analyse runs/* --set severity_ttc_serious_s=1.2
      cosim analyse runs/midblock_zebra-vo_mpc-1-1 --ssam

    \b
    Exit codes: 0 success, 2 a folder or a threshold is wrong (the other folders are analysed).
    """
    from analysis.errors import AnalysisError
    from analysis.recording.ssam import export_ssam
    from analysis.results.analyse import analyse_run
    from analysis.thresholds import with_settings
    from cosim.errors import InputError
    from cosim.presentation.notes import unverified
    from cosim.presentation.numbers import read_row, run_table
    from cosim.running.request import parse_settings

    try:
        thresholds = with_settings(parse_settings(settings or [], "severity_ttc_serious_s=1.2"))
    except AnalysisError as error:
        raise InputError(f"--set {error}") from error
    console = terminal.console()
    failed: list[Path] = []
    for note in unverified(folder for folder in folders if (folder / "run.json").is_file()):
        console.print(note, soft_wrap=True)
    for folder in folders:
        try:
            analyse_run(folder, thresholds)
            if ssam:
                export_ssam(folder)
        except AnalysisError as error:
            failed.append(folder)
            typer.echo(f"cosim: {error}", err=True)
            continue
        console.print(f"{folder}/encounters.csv, {folder}/runs.csv", soft_wrap=True)
        if len(folders) == 1:
            console.print(run_table(read_row(folder)))
    if len(folders) > 1 and failed:
        typer.echo(
            f"cosim: {len(failed)} of {len(folders)} folders not analysed: {', '.join(map(str, failed))}",
            err=True,
        )
    return 2 if failed else 0
