"""``cosim validate``: is the simulation like the street?"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.batch import show_result
from cosim.cli.options import Bodies, Crs, Debug, Jobs, Tracks
from cosim.cli.tracks_tables import fit_table
from cosim.cli.validation_tables import comparison_table


def validate(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="SUMO configuration, or a scenario's name or folder.")
    ],
    tracks: Tracks,
    seeds: Annotated[str, typer.Option(metavar="SEEDS", help='Seeds, such as "1-10" or "1, 2, 5".')] = "1-5",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Output folder; resumes an earlier validation.",
            show_default="runs/validate-<SCENARIO>",
        ),
    ] = None,
    jobs: Jobs = None,
    types: Annotated[
        Path | None,
        typer.Option(
            "--types",
            metavar="FILE",
            help="Types of road users, as cosim calibrate writes them.",
            show_default="the variant's, else SUMO's",
        ),
    ] = None,
    begin: Annotated[
        float | None, typer.Option("--from", metavar="S", help="Begin at this second of the recording.")
    ] = None,
    end: Annotated[
        float | None, typer.Option("--to", metavar="S", help="End at this second of the recording.")
    ] = None,
    crs: Crs = None,
    bodies: Bodies = None,
    debug: Debug = False,
) -> int:
    """Compare simulated road users with real ones, whose departures, ways and modes are simulated again.

    \b
    Examples:
      cosim validate street.sumocfg --tracks tracks.csv --seeds 1-10 --out results/validation
      cosim validate braunschweig --tracks tasi

    \b
    Exit codes: 0 compared, 2 bad input (nothing is run), 3 a run failed or is invalid, or the validation was
    interrupted; what is finished is compared.
    """
    from cosim.batches.batch import prepared
    from cosim.batches.progress import shown_checks, shown_tally
    from cosim.validation.span import span_of
    from cosim.validation.validate import ValidationRequest, finished, planned

    again = shlex.join(["cosim", *sys.argv[1:]])
    plan = planned(
        ValidationRequest(scenario, tracks, seeds, out, jobs, crs, bodies, types, span_of(begin, end), again)
    )
    console = terminal.console()
    console.print(fit_table(plan.found.placed.fits))
    departed = ", ".join(f"{count} {kind}" for kind, count in sorted(plan.demand.departed.items()))
    console.print(f"simulated again: {departed}", soft_wrap=True)
    for kind, count in sorted(plan.demand.left_out.items()):
        typer.echo(f"cosim: note: {count} {kind} hardly moved or have no way through the network", err=True)
    with prepared(plan.batch, shown_checks()) as batch:
        result = batch.run(shown_tally())
        code = show_result(batch, result)
    if result.tally.done:
        done = finished(plan)
        console.print(comparison_table(done.compared))
        console.print(f"{done.folder}/validation.csv", soft_wrap=True)
    return code
