"""``cosim run``: one scenario, one controller, one seed."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cosim.cli import apart, names, terminal
from cosim.cli.apart import OWN_PROCESS
from cosim.cli.options import Debug, Out, Settings
from cosim.running.request import RunRequest, parse_settings

if TYPE_CHECKING:
    from cosim.running.execution import Outcome

Scenario = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO",
        help="Scenario name or folder, suite:NAME/CASE, or SUMO configuration.",
        autocompletion=names.targets,
    ),
]
ControllerName = Annotated[
    str,
    typer.Option(metavar="NAME", help="Controller that drives the egos.", autocompletion=names.drivers),
]
Duration = Annotated[
    float | None,
    typer.Option(
        "--duration-s",
        metavar="S",
        help="Recorded time, after the warm-up [s].",
        show_default="as the scenario",
    ),
]
Step = Annotated[
    float | None,
    typer.Option("--step-s", metavar="S", help="Step length [s].", show_default="as the scenario"),
]
Placement = Annotated[
    str | None,
    typer.Option(metavar="hybrid|move", help="How SUMO's vehicle is moved.", show_default="as the scenario"),
]
EgoRoute = Annotated[
    str | None, typer.Option(metavar='"E1 E2 …"', help="Add one ego that drives these edges.")
]
EgoVehicle = Annotated[str | None, typer.Option(metavar="ID", help="Take over this vehicle of the demand.")]
EgoShare = Annotated[
    float | None, typer.Option(metavar="SHARE", help="Take over this share of the passenger cars.")
]
SensingName = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Sensing model; see cosim list sensing.",
        autocompletion=names.sensing,
        show_default="as the scenario",
    ),
]
Record = Annotated[
    str,
    typer.Option(
        metavar="egos|everybody",
        help="Whom to record and judge; with everybody, all traffic near crossings, and no ego is needed.",
    ),
]


def run(
    context: typer.Context,
    scenario: Scenario,
    controller: ControllerName = "vo_mpc",
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 1,
    out: Out = None,
    settings: Settings = None,
    duration_s: Duration = None,
    step_s: Step = None,
    actuation: Placement = None,
    ego_route: EgoRoute = None,
    ego_vehicle: EgoVehicle = None,
    ego_share: EgoShare = None,
    sensing: SensingName = None,
    record: Record = "egos",
    gui: Annotated[bool, typer.Option("--gui", help="Show the run in sumo-gui.")] = False,
    debug: Debug = False,
) -> int:
    """Drive an ego through a scenario and report how safe it was.

    \b
    Examples:
      cosim run midblock_zebra
      cosim run midblock_unmarked --controller aeb --seed 7 --out results/aeb-7
      cosim run midblock_zebra --set pedestrians_per_hour=600 --set vehicles_per_hour=1000
      cosim run bus_stop_occlusion --sensing onboard --set range_m=40
      cosim run suite:fmvss127/crossing_right_25_30kmh --controller aeb
      cosim run town.sumocfg --ego-route "e1 e2 e3" --duration-s 600
      cosim run town.sumocfg --ego-share 0.1 --controller vo_mpc
      cosim run town.sumocfg --ego-vehicle car.12 --gui

    \b
    Exit codes: 0 success, 2 bad input, 3 the run failed after its first step.
    """
    request = RunRequest(
        scenario=scenario,
        controller=controller,
        seed=seed,
        settings=parse_settings(settings or []),
        duration_s=duration_s,
        step_s=step_s,
        actuation=actuation,
        ego_route=tuple((ego_route or "").split()),
        ego_vehicle=ego_vehicle,
        ego_share=ego_share,
        sensing=sensing,
        record=record,
        gui=gui,
        out=out,
    )
    if context.obj is OWN_PROCESS and not gui:
        ended = apart.begin()
        if isinstance(ended, apart.Ended):
            if ended.crash:
                return _tell_of_crash(ended)
            raise SystemExit(ended.code)  # everything was said there
        try:
            return _run(request, ended, debug)
        except (MemoryError, SystemError) as error:
            ended.give_up(error)
            raise
    return _run(request, apart.Inside(), debug)


def _tell_of_crash(ended: apart.Ended) -> int:
    """Keep the recording so far and report the crash."""
    from cosim.running.execution import salvage

    reason = f"the simulation process was ended by {ended.crash}"
    if not ended.told:
        typer.echo(f"cosim: {reason} before its first step", err=True)
        return 3
    return _show(salvage(Path(ended.told), reason))


def _run(request: RunRequest, inside: apart.Inside, debug: bool) -> int:
    from cosim.cli.progress import shown_progress
    from cosim.running.execution import execute

    with shown_progress() as progress:
        outcome = execute(request, progress, inside.tell)
    if debug and outcome.error is not None:
        traceback.print_exception(outcome.error)
    if isinstance(outcome.error, MemoryError):
        inside.give_up(outcome.error)  # the other process has the memory that its files may still need
    return _show(outcome)


def _show(outcome: Outcome) -> int:
    from cosim.presentation.notes import run_notes
    from cosim.presentation.numbers import run_table

    console = terminal.console()
    if outcome.row is not None:
        console.print(run_table(outcome.row, [("control over SUMO's step", _ratio(outcome.description))]))
    console.print(f"\nfiles: {outcome.folder}", soft_wrap=True)
    for note in run_notes(outcome.description):
        typer.echo(f"cosim: note: {note}", err=True)
    if outcome.invalid_reason:
        typer.echo(f"cosim: the run is invalid: {outcome.invalid_reason}", err=True)
        return 3
    return 0


def _ratio(description: dict[str, Any]) -> str:
    control, world = description["wall_control_s"], description["wall_world_s"]
    return f"{control / world:.2f}" if world else "–"
