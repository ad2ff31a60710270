"""``cosim falsify``: what breaks a controller although a careful driver would have avoided it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug, Jobs, Scheduler, Settings, here_or_elsewhere
from cosim.cli.search_options import ControllerName, CriteriaFile, OwnFolder, RunTimeout, Searched, Space

if TYPE_CHECKING:
    from cosim.search.search import FalsifyRequest, Found

MOST_KINDS = 12
"""Kinds that are printed."""

Budget = Annotated[int, typer.Option(metavar="N", min=1, help="Number of trials.")]
Method = Annotated[str, typer.Option(metavar="NAME", help="cma-es, tpe, sobol, random or nsga-ii.")]
Seed = Annotated[int, typer.Option(metavar="N", help="Seed of the search and of its runs.")]
TimeBudget = Annotated[
    float | None, typer.Option(metavar="S", min=0, help="Begin no generation after so many seconds.")
]
StopAtFirst = Annotated[
    bool, typer.Option("--stop-at-first", help="Stop after the generation with the first failure.")
]
Shrink = Annotated[
    bool, typer.Option("--shrink/--no-shrink", help="Find the smallest change back to success.")
]
Report = Annotated[
    bool, typer.Option("--report/--no-report", help="Write report.html with a replay of each kind.")
]


def falsify(
    scenario: Searched,
    controller: ControllerName = "vo_mpc",
    budget: Budget = 200,
    method: Method = "cma-es",
    seed: Seed = 1,
    space: Space = None,
    criteria: CriteriaFile = None,
    settings: Settings = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    time_budget: TimeBudget = None,
    stop_at_first: StopAtFirst = False,
    shrink: Shrink = True,
    report: Report = True,
    run_timeout_s: RunTimeout = 600.0,
    out: OwnFolder = None,
    debug: Debug = False,
) -> int:
    """Search a scenario for what a controller fails at although a careful driver would not have.

    A trial is one passage of one ego. Failures that nobody could have prevented are listed apart. Repeat the
    command to resume. The folder DIR/failures is a regression suite for cosim check.

    \b
    Examples:
      cosim falsify jaywalk_arterial --controller aeb --budget 200 --out results/aeb
      cosim falsify town.sumocfg --controller vo_mpc --budget 100 --stop-at-first
      cosim falsify jaywalk_arterial --controller aeb --method tpe --space space.toml --time-budget 600

    \b
    Exit codes: 0 the search is done, whatever it found, 2 bad input (nothing is run), 3 no trial has a
    result, or the search was interrupted. cosim check DIR/failures exits 1 while any of them still fails.
    """
    from cosim.batches.progress import shown_tally
    from cosim.errors import InputError
    from cosim.running.request import parse_settings
    from cosim.search.report import require_packages, write_report
    from cosim.search.search import FalsifyRequest, command, prepared

    here_or_elsewhere(jobs, scheduler)
    if not 0 <= seed < 2**31 - 1000:
        raise InputError(f"--seed: expected a whole number from 0 to {2**31 - 1001}, got {seed}")
    request = FalsifyRequest(
        scenario,
        controller,
        budget,
        method,
        seed,
        parse_settings(settings or []),
        space,
        criteria,
        out,
        jobs,
        scheduler,
        time_budget,
        stop_at_first,
        shrink,
        run_timeout_s,
    )
    if report:
        require_packages()
    search = prepared(request)
    for note in search.subject.notes:
        typer.echo(f"cosim: note: {note}", err=True)
    try:
        found = search.run(shown_tally())
    except KeyboardInterrupt:
        typer.echo(f"cosim: interrupted; what is finished is kept; to resume: {command(request)}", err=True)
        return 3
    _show(request, found)
    if report:
        terminal.console().print(f"report: {write_report(search, found, shown_tally())}", soft_wrap=True)
    return 0


def _show(request: FalsifyRequest, found: Found) -> None:
    """Print what was found, in words."""
    from collections import Counter

    from analysis.search.results import FAIL, INVALID, UNPREVENTABLE
    from cosim.search.regression import check_command

    console = terminal.console()

    def say(text: str) -> None:
        console.print(text, soft_wrap=True)

    counts = Counter(one.status for one in found.tried)
    first = next((number for number, one in enumerate(found.tried, 1) if one.status == FAIL), None)
    say(
        f"{len(found.tried)} runs of {request.controller}, by {request.method}: "
        f"{_counted(counts[FAIL], 'preventable failure')} of {_counted(len(found.kinds), 'kind')}"
        + (f", the first in run {first}" if first else "")
        + f"; {_counted(counts[UNPREVENTABLE], 'run')} with a failure that nobody could have prevented, "
        "listed apart"
    )
    if found.stopped:
        say(f"Stopped early: {found.stopped}.")
    if counts[INVALID]:
        reason = next(one.invalid for one in found.tried if one.status == INVALID)
        say(f"{counts[INVALID]} runs are not valid, for instance: {reason}")
    for row in found.kinds[:MOST_KINDS]:
        say(f"\n{row.number}. {row.kind.name}")
        count = len(row.kind.failures)
        say(f"   {_counted(count, 'run')}; smallest margin {row.kind.worst.margin:.2f}")
        if row.change:
            say(f"   smallest change back to success found: {row.change}")
        say(f"   repeat: {row.command}")
    if len(found.kinds) > MOST_KINDS:
        more = _counted(len(found.kinds) - MOST_KINDS, "more kind")
        say(f"\n… and {more} in {found.folder}/kinds.csv")
    if found.influences:
        told = ", ".join(
            f"{one.axis} {one.first_order:.2f} ± {one.half_width:.2f}" for one in found.influences[:3]
        )
        say(f"\nWhat decides most by itself (Sobol's first-order index): {told}")
    if found.kinds:
        say(f"regression suite: {check_command(request.controller, found.folder)}")
    say(f"files: {found.folder}")


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
