"""``cosim stand-in``: a controller in the place of a recorded vehicle."""

from __future__ import annotations

from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Bodies, Crs, Debug, Out, Settings, Tracks


def stand_in(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="SUMO configuration, or a scenario's name or folder.")
    ],
    tracks: Tracks,
    vehicle: Annotated[str, typer.Option(metavar="ID", help="Recorded vehicle whose place the ego takes.")],
    controller: Annotated[str, typer.Option(metavar="NAME", help="Drives the ego.")] = "vo_mpc",
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 1,
    out: Out = None,
    settings: Settings = None,
    crs: Crs = None,
    bodies: Bodies = None,
    debug: Debug = False,
) -> int:
    """Drive in the place of a recorded vehicle; everybody else moves as recorded, and reacts to nobody.

    An encounter in which the ego was not where the recorded vehicle had been is marked: its pedestrian met
    somebody else than they had reacted to.

    \b
    Example:
      cosim stand-in street.sumocfg --tracks tracks.csv --vehicle 17 --controller aeb --out results/stand-in

    \b
    Exit codes: 0 success, 2 bad input, 3 the run failed after its first step.
    """
    from cosim.running.request import parse_settings
    from cosim.validation.stand_in import StandInRequest, stand_in

    done = stand_in(
        StandInRequest(
            scenario, tracks, vehicle, controller, seed, parse_settings(settings or []), out, crs, bodies
        )
    )
    console = terminal.console()
    for one in done.met:
        told = "as recorded" if one.could_react else f"could not react: the ego was {one.off_m:.1f} m off"
        console.print(f"{one.pedestrian}: {one.distance:.2f} m, {one.severity}; {told}", soft_wrap=True)
    reacted = sum(one.could_react for one in done.met)
    console.print(f"{len(done.met)} encounters, {reacted} in which the people could react")
    console.print(f"{done.folder}/stand_in.csv", soft_wrap=True)
    if done.has_signals:
        typer.echo(
            "cosim: note: the ego obeys the scenario's signals, whose phases are not those of the recording",
            err=True,
        )
    if done.outcome.invalid_reason:
        typer.echo(f"cosim: the run is invalid: {done.outcome.invalid_reason}", err=True)
        return 3
    return 0
