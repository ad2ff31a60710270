"""``cosim screen``: which crossings of a network are dangerous, and why."""

from __future__ import annotations

import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli.batch import show_result
from cosim.cli.options import Debug, Jobs, Scheduler, here_or_elsewhere
from cosim.cli.screen_tables import show_changes, show_ranking
from cosim.errors import SimulationError

if TYPE_CHECKING:
    from analysis.screening.writing import Screened
    from cosim.screening.screen import Plan, ScreenRequest

LEAST_PEDESTRIANS = 30


class Measure(StrEnum):
    """What ranks follow; those of ``analysis.screening.ranking``, which loads numerical libraries."""

    RISK = "risk"
    CONFLICTS = "conflicts"


Town = Annotated[
    str, typer.Argument(metavar="TOWN", help="SUMO configuration, or a scenario's name or folder.")
]
Seeds = Annotated[str, typer.Option(metavar="SEEDS", help='Seeds, such as "1-10" or "1, 2, 5".')]
Folder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        help="Output folder; resumes an earlier screening.",
        show_default="runs/screen-<TOWN>",
    ),
]
Begin = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar="TIME",
        help="Count from this simulated time on: 07:00, or seconds.",
        show_default="as the scenario",
    ),
]
End = Annotated[
    str | None,
    typer.Option("--to", metavar="TIME", help="End at this time.", show_default="as the scenario"),
]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a scenario parameter; repeatable."),
]
LeastPedestrians = Annotated[
    float,
    typer.Option(
        metavar="N", min=0, help="Crossings with fewer pedestrians in all runs are listed, not ranked."
    ),
]
RankBy = Annotated[
    Measure,
    typer.Option(
        "--rank-by",
        help="risk: conflicts for each pedestrian, by how likely a pedestrian would die at the speeds there; "
        "conflicts: these alone.",
    ),
]
Against = Annotated[
    str | None,
    typer.Option(metavar="TOWN", help="Compare with this configuration, on the same seeds."),
]
Alternative = Annotated[
    list[str] | None,
    typer.Option("--alt", metavar="KEY=VALUE", help="Compare with this scenario parameter; repeatable."),
]


def screen(
    scenario: Town,
    seeds: Seeds = "1-10",
    out: Folder = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    begin: Begin = None,
    end: End = None,
    settings: Settings = None,
    min_pedestrians: LeastPedestrians = LEAST_PEDESTRIANS,
    rank_by: RankBy = Measure.RISK,
    against: Against = None,
    alt: Alternative = None,
    debug: Debug = False,
) -> int:
    """Rank a network's crossings by the risk that vehicles are to pedestrians there.

    SUMO's own traffic is simulated, no ego is needed. --against and --alt screen an alternative too and
    say what it changes at each crossing. Repeat the command to resume.

    \b
    Examples:
      cosim screen town.sumocfg --out results/town
      cosim screen town.sumocfg --seeds 1-20 --from 07:00 --to 08:00 --set step_s=0.1
      cosim screen midblock_zebra --seeds 1-5 --from 60 --to 600
      cosim screen today.sumocfg --against zone30.sumocfg
      cosim screen midblock_zebra --alt pedestrians_per_hour=600

    \b
    Exit codes: 0 ranked, 2 bad input (nothing is run), 3 a run failed or is invalid, or the screening was
    interrupted; what is finished is ranked.
    """
    from cosim.running.request import parse_settings
    from cosim.screening.clock import seconds
    from cosim.screening.screen import ScreenRequest, alternative, check_comparable, compared, planned

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
    requests = [request]
    if against is not None or alt:
        requests.append(alternative(request, against, parse_settings(alt or [])))
    plans = [planned(one) for one in requests]
    for note in dict.fromkeys(note for plan in plans for note in plan.notes):
        typer.echo(f"cosim: note: {note}", err=True)
    if len(plans) > 1:
        check_comparable(*plans)
        _checked(plans[-1])
    codes, rankings = [], []
    for one, plan in zip(requests, plans, strict=True):
        code, stopped, ranking = _screened(one, plan, min_pedestrians, rank_by.value)
        codes.append(code)
        if stopped:
            return code
        if ranking is not None:
            rankings.append(ranking)
    if len(requests) > 1:
        if len(rankings) < len(requests):
            raise SimulationError("no comparison: base or alternative has no finished run")
        show_changes(compared(request, *rankings))
    return max(codes)


def _checked(plan: Plan) -> None:
    """Refuse an alternative that cannot be run before the base runs."""
    from cosim.batches.batch import prepared
    from cosim.batches.progress import shown_checks

    with prepared(plan.batch, shown_checks()):
        pass


def _screened(request: ScreenRequest, plan: Plan, least: float, by: str) -> tuple[int, bool, Screened | None]:
    """Make the runs and print the ranking; return exit code, whether it was stopped, and the ranking."""
    from cosim.batches.batch import prepared
    from cosim.batches.progress import shown_checks, shown_tally
    from cosim.screening.screen import ranked

    with prepared(plan.batch, shown_checks()) as batch:
        result = batch.run(shown_tally())
        code = show_result(batch, result)
    ranking = ranked(request, least, by) if result.tally.done else None
    if ranking is not None:
        show_ranking(ranking, least)
    return code, bool(result.stopped), ranking
