"""``cosim calibrate``: types of road users from real tracks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.batch import show_result
from cosim.cli.options import Bodies, Crs, Debug, Jobs, Tracks
from cosim.cli.validation_tables import before_and_after, estimates_table


def calibrate(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="SUMO configuration, or a scenario's name or folder.")
    ],
    tracks: Tracks,
    split: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="Second of the recording at which the held-out part begins.",
            show_default="the middle",
        ),
    ] = None,
    seeds: Annotated[
        str, typer.Option(metavar="SEEDS", help="Of the runs before and after; empty: none are made.")
    ] = "1-3",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Output folder, new or empty.",
            show_default="runs/calibrate-<SCENARIO>",
        ),
    ] = None,
    jobs: Jobs = None,
    crs: Crs = None,
    bodies: Bodies = None,
    debug: Debug = False,
) -> int:
    """Estimate walking and desired speeds, car following and gap acceptance from real tracks.

    The first part of the recording is used. The second one is simulated with SUMO's own types and with the
    calibrated ones, and compared with the street.

    \b
    Examples:
      cosim calibrate street.sumocfg --tracks tracks.csv --out results/calibration
      cosim calibrate braunschweig --tracks tasi --split 450 --seeds 1-5

    \b
    Exit codes: 0 calibrated, 2 bad input, 3 a run before or after failed or is invalid.
    """
    from cosim.batches.batch import prepared
    from cosim.batches.progress import shown_checks, shown_tally
    from cosim.batches.study import check_seeds
    from cosim.validation.calibrate import CalibrationRequest, calibrated, held_out
    from cosim.validation.validate import finished, planned

    request = CalibrationRequest(scenario, tracks, split, out, crs, bodies)
    if seeds.strip():
        check_seeds(seeds, "cosim calibrate")
    done = calibrated(request)
    console = terminal.console()
    console.print(estimates_table(done.estimates.values()))
    console.print(f"{done.file}", soft_wrap=True)
    if not seeds.strip():
        return 0
    codes, results = [0], []
    for one in held_out(request, done, seeds, jobs):
        plan = planned(one)
        with prepared(plan.batch, shown_checks()) as batch:
            result = batch.run(shown_tally())
            codes.append(show_result(batch, result))
        if result.stopped or not result.tally.done:
            return max(codes)
        results.append(finished(plan).compared)
    console.print(before_and_after(*results))
    return max(codes)
