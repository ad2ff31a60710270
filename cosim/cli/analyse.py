"""``cosim analyse``: recompute the CSV files from recordings, or judge the tracks of real road users."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Bodies, Crs, Debug, NetworkFile, Out, Xlsx

if TYPE_CHECKING:
    from analysis.thresholds import Thresholds


def analyse(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN_DIR…|TRACKS", help="Folders of recorded runs; with --network a file of tracks."
        ),
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Threshold of the analysis; repeatable."),
    ] = None,
    ssam: Annotated[
        bool, typer.Option("--ssam", help="Also write run.trj in SSAM's format and ssam_id_map.csv.")
    ] = False,
    xlsx: Xlsx = False,
    network: NetworkFile = None,
    out: Out = None,
    crs: Crs = None,
    bodies: Bodies = None,
    debug: Debug = False,
) -> int:
    """Recompute encounters.csv and runs.csv from recorded runs, without simulating.

    With --network, judge the encounters of real road users: tracks as a CSV, in the layout of inD, rounD,
    uniD or DLR Urban Traffic, or as SUMO's floating car data.

    \b
    Examples:
      cosim analyse runs/midblock_zebra-vo_mpc-1-1
      cosim analyse runs/* --set severity_ttc_serious_s=1.2
      cosim analyse runs/midblock_zebra-vo_mpc-1-1 --ssam --xlsx
      cosim analyse tracks.csv --network town.net.xml --out results/street

    \b
    Exit codes: 0 success, 2 a folder, a file of tracks or a threshold is wrong (other folders are analysed).
    """
    from analysis.errors import AnalysisError
    from analysis.thresholds import with_settings
    from cosim.errors import InputError
    from cosim.running.request import parse_settings

    try:
        thresholds = with_settings(parse_settings(settings or [], "severity_ttc_serious_s=1.2"))
    except AnalysisError as error:
        raise InputError(f"--set {error}") from error
    if network is not None:
        return _judge_tracks(folders, network, out, crs, bodies, thresholds, ssam, xlsx)
    for flag, given in (("--out", out), ("--crs", crs), ("--bodies", bodies)):
        if given is not None:
            raise InputError(f"{flag} belongs to tracks of real road users: expected --network, too")
    return _analyse_runs(folders, thresholds, ssam, xlsx)


def _analyse_runs(folders: list[Path], thresholds: Thresholds, ssam: bool, xlsx: bool) -> int:
    from analysis.errors import AnalysisError
    from analysis.recording.ssam import export_ssam
    from analysis.results.analyse import analyse_run
    from cosim.presentation.notes import unverified
    from cosim.presentation.numbers import read_row, run_table

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
        if xlsx:
            from cosim.presentation.workbook import write_workbook

            console.print(f"{write_workbook([folder], folder)}", soft_wrap=True)
        if len(folders) == 1:
            console.print(run_table(read_row(folder)))
    if len(folders) > 1 and failed:
        typer.echo(
            f"cosim: {len(failed)} of {len(folders)} folders not analysed: {', '.join(map(str, failed))}",
            err=True,
        )
    return 2 if failed else 0


def _judge_tracks(
    files: list[Path],
    network: Path,
    out: Path | None,
    crs: str | None,
    bodies: str | None,
    thresholds: Thresholds,
    ssam: bool,
    xlsx: bool,
) -> int:
    from cosim.cli.tracks_tables import fit_table, tracks_notes
    from cosim.errors import InputError
    from cosim.tracks.judging import TracksRequest, judge

    if len(files) != 1:
        raise InputError(f"--network: expected one file of tracks, got {len(files)}")
    for flag, given in (("--ssam", ssam), ("--xlsx", xlsx)):
        if given:
            raise InputError(f"{flag} writes the egos of a run, and tracks have none")
    done = judge(TracksRequest(str(files[0]), network, crs, bodies, out), thresholds)
    console = terminal.console()
    console.print(fit_table(done.fits))
    console.print(
        f"{done.encounters} encounters of vehicles and pedestrians, {done.conflicts} of them conflicts"
    )
    console.print(f"{done.folder}/traffic_encounters.csv", soft_wrap=True)
    for note in tracks_notes(done):
        typer.echo(f"cosim: note: {note}", err=True)
    return 0
