"""``cosim screen``: which crossings of a network are dangerous, and why."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.batch import show_result
from cosim.cli.options import Debug, Jobs, Scheduler, here_or_elsewhere

if TYPE_CHECKING:
    from analysis.screening.writing import Screened
    from analysis.tables.cells import Row

SHOWN = 10
"""Crossings of the ranking that are printed."""
LEAST_PEDESTRIANS = 30


def screen(
    scenario: Annotated[
        str, typer.Argument(metavar="TOWN", help="SUMO configuration, or a scenario's name or folder.")
    ],
    seeds: Annotated[str, typer.Option(metavar="SEEDS", help='Seeds, such as "1-10" or "1, 2, 5".')] = "1-10",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Output folder; resumes an earlier screening.",
            show_default="runs/screen-<TOWN>",
        ),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    begin: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="TIME",
            help="Count from this simulated time on: 07:00, or seconds.",
            show_default="as the scenario",
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option("--to", metavar="TIME", help="End at this time.", show_default="as the scenario"),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set a scenario parameter; repeatable."),
    ] = None,
    min_pedestrians: Annotated[
        float,
        typer.Option(
            metavar="N", min=0, help="Crossings with fewer pedestrians in all runs are listed, not ranked."
        ),
    ] = LEAST_PEDESTRIANS,
    debug: Debug = False,
) -> int:
    """Rank a network's crossings by their conflicts between vehicles and pedestrians.

    SUMO's own traffic is simulated, no ego is needed. Repeat the command to resume.

    \b
    Examples:
      cosim screen town.sumocfg --out results/town
      cosim screen town.sumocfg --seeds 1-20 --from 07:00 --to 08:00 --set step_s=0.1
      cosim screen midblock_zebra --seeds 1-5 --from 60 --to 600

    \b
    Exit codes: 0 ranked, 2 bad input (nothing is run), 3 a run failed or is invalid, or the screening was
    interrupted; what is finished is ranked.
    """
    from cosim.batches.batch import prepared
    from cosim.batches.progress import shown_checks, shown_tally
    from cosim.running.request import parse_settings
    from cosim.screening.clock import seconds
    from cosim.screening.screen import ScreenRequest, planned, ranked

    here_or_elsewhere(jobs, scheduler)
    request = ScreenRequest(
        scenario,
        seeds,
        parse_settings(settings or []),
        None if begin is None else seconds(begin, "--from"),
        None if end is None else seconds(end, "--to"),
        out,
        jobs,
        scheduler,
        shlex.join(["cosim", *sys.argv[1:]]),
    )
    plan = planned(request)
    for note in plan.notes:
        typer.echo(f"cosim: note: {note}", err=True)
    with prepared(plan.batch, shown_checks()) as batch:
        result = batch.run(shown_tally())
        code = show_result(batch, result)
    if result.tally.done:
        _show_ranking(ranked(request, min_pedestrians), min_pedestrians)
    return code


def _show_ranking(found: Screened, least: float) -> None:
    from rich.table import Table

    rows = [row for row in found.rows if row["rank"] is not None]
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("rank", "95 %", "crossing", "conflicts per 1000 pedestrians", "expected", "why"):
        table.add_column(heading, overflow="fold")
    for row in rows[:SHOWN]:
        table.add_row(*_line(row))
    console = terminal.console()
    if rows:
        console.print(table)
    worse, left_out = sum(bool(row["worse"]) for row in rows), len(found.rows) - len(rows)
    typer.echo(
        f"{len(found.rows)} crossings, {len(rows)} ranked over {len(found.seeds)} seeds, "
        f"{worse} significantly worse than the others; {left_out} with fewer than {least:g} pedestrians"
    )
    if not any(row["pedestrians_per_h"] for row in found.rows):
        typer.echo("cosim: note: nobody walked over a crossing; does the demand have persons?", err=True)
    if len(found.seeds) == 1:
        typer.echo("cosim: note: a rank has no interval with a single seed: use --seeds 1-10", err=True)
    if not any(file.suffix == ".geojson" for file in found.files):
        typer.echo("cosim: note: the network has no projection: places are in metres, no GeoJSON", err=True)
    typer.echo(f"files: {', '.join(map(str, found.files))}")


def _line(row: Row) -> list[str]:
    known = row["rank_lo"] is not None
    interval = f"{row['rank_lo']:.0f}–{row['rank_hi']:.0f}" if known else ""
    rates = [f"{row[name]:.1f}" for name in ("conflicts_per_1000_ped", "expected_conflicts_per_1000_ped")]
    name = f"{row['crossing_id']} (worse)" if row["worse"] else str(row["crossing_id"])
    return [f"{row['rank']:g}", interval, name, *rates, str(row["reasons"])]
