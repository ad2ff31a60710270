"""``cosim batch``: the runs of a study on many processes, until all are done."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug, Jobs, Scheduler, here_or_elsewhere

if TYPE_CHECKING:
    from cosim.batches.batch import Batch, Result

MOST_ROWS = 40
"""Rows of the matrix that are shown."""


def batch(
    study: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study file.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Output folder; resumes an earlier batch.",
            show_default="runs/<STUDY>",
        ),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    drop_recordings: Annotated[
        bool, typer.Option("--drop-recordings", help="Keep only the numbers of each run.")
    ] = False,
    allow_programs: Annotated[
        bool,
        typer.Option("--allow-programs", help="Let the study name controllers by file, process: or fmu:."),
    ] = False,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Check everything and show the runs and their time; run nothing."),
    ] = False,
    debug: Debug = False,
) -> int:
    """Run a study: scenarios × controllers × seeds × varied parameters.

    Repeat the command to resume an interrupted batch.

    \b
    Examples:
      cosim batch study.toml --dry-run
      cosim batch study.toml --out results/study --jobs 2
      cosim batch study.toml --out results/study --scheduler tcp://127.0.0.1:8786 --drop-recordings

    \b
    A study file:
      scenarios = ["midblock_zebra", "town/town.sumocfg"]
      controllers = ["sumo", "aeb", "vo_mpc"]
      seeds = "1-30"
      run_timeout_s = 600
      [set]
      duration_s = 300
      [vary]
      pedestrians_per_hour = [200, 600]

    \b
    Exit codes: 0 all runs are valid, 2 bad input (nothing is run), 3 a run failed, is invalid or damaged,
    or the batch was interrupted.
    """
    from cosim.batches.batch import BatchRequest, prepared
    from cosim.batches.progress import shown_checks, shown_tally

    here_or_elsewhere(jobs, scheduler)
    request = BatchRequest(study, out, jobs, scheduler, drop_recordings, allow_programs)
    with prepared(request, shown_checks()) as one:
        if dry_run:
            _show_plan(one)
            return 0
        return show_result(one, one.run(shown_tally()))


def _show_plan(one: Batch) -> None:
    """Print every configuration and the remaining work."""
    from rich.table import Table

    from cosim.batches.estimate import in_words

    missing = Counter(job.configuration for job in one.missing)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("scenario", "controller", "varied"):
        table.add_column(heading, overflow="fold")
    for heading in ("seeds", "finished"):
        table.add_column(heading, justify="right")
    seeds = len(one.matrix.seeds)
    for each in one.matrix.configurations[:MOST_ROWS]:
        varied = " ".join(f"{key}={value}" for key, value in each.varied)
        done = seeds - missing[each]
        table.add_row(each.scenario_name, each.controller, varied, str(seeds), str(done))
    for name, told in one.ledger.damaged.items():
        typer.echo(f"cosim: damaged: {name}: {told}", err=True)
    console = terminal.console()
    console.print(table)
    if len(one.matrix.configurations) > MOST_ROWS:
        console.print(f"… and {len(one.matrix.configurations) - MOST_ROWS} more configurations")
    processes = one.request.processes
    alone, together = one.estimate(1), one.estimate(processes)
    console.print(
        f"\n{len(one.jobs)} runs, {len(one.jobs) - len(one.missing)} finished, {len(one.missing)} missing: "
        f"about {in_words(alone.wall_s)} in one process, {in_words(together.wall_s)} in {processes} "
        f"({together.basis})",
        soft_wrap=True,
    )


def show_result(one: Batch, result: Result) -> int:
    """Print how the batch ended and return the exit code."""
    from cosim.batches.ledger import FAILURES
    from cosim.presentation.notes import unverified

    tally, folder = result.tally, one.ledger.folder
    damaged = f", {len(result.damaged)} damaged" if result.damaged else ""
    tables = f"; tables: {folder}/*.csv" if any(folder.glob("*.csv")) else ""
    typer.echo(f"{tally.done} of {tally.total} runs finished, {tally.failed} failed{damaged}{tables}")
    for note in unverified(one.ledger.run_folder(name) for name in one.ledger.whole()):
        typer.echo(note)
    for note in result.notes:
        typer.echo(f"cosim: note: {note}", err=True)
    for name, told in result.damaged.items():
        typer.echo(f"cosim: damaged: {name}: {told}", err=True)
    for name, reason in result.not_valid.items():
        typer.echo(f"cosim: invalid: {name}: {reason}", err=True)
    if tally.failed:
        where = folder / FAILURES
        reasons = f"; for the reasons see {where}" if where.is_file() else ""
        typer.echo(f"cosim: {tally.failed} runs failed{reasons}", err=True)
    if result.stopped:
        left = tally.total - tally.done - len(one.ledger.damaged)
        purpose = f"to run the other {left}" if left else "to write the tables"
        typer.echo(
            f"cosim: {result.stopped}; {tally.done} of {tally.total} runs are finished{damaged}; "
            f"{purpose}, repeat: {one.request.command()}",
            err=True,
        )
    return 0 if result.good else 3
