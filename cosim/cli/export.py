"""``cosim export``: an encounter or a run in the formats of other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug

FORMATS = ("openscenario", "fcd")


def export(
    folder: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="Folder of a recorded run.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the files, new or empty.")],
    kind: Annotated[str, typer.Option("--format", metavar="|".join(FORMATS), help="Format.")] = FORMATS[0],
    encounter: Annotated[
        int | None, typer.Option(metavar="N", help="The encounter_id; needed for openscenario.")
    ] = None,
    network: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="The run's network (.net.xml).",
            show_default="that of a built-in scenario or of a protocol's case",
        ),
    ] = None,
    traffic: Annotated[
        bool, typer.Option("--traffic", help="The encounter is one of traffic_encounters.csv.")
    ] = False,
    road: Annotated[
        bool, typer.Option("--road/--no-road", help="Whether to write the network as OpenDRIVE.")
    ] = True,
    debug: Debug = False,
) -> int:
    """Write an encounter as OpenSCENARIO and OpenDRIVE, or a run as SUMO's floating car data.

    \b
    Examples:
      cosim export runs/midblock_zebra-vo_mpc-1-1 --encounter 3 --out encounter-3
      cosim export runs/town-vo_mpc-1-1 --encounter 1 --network town.net.xml --out encounter-1
      cosim export runs/midblock_zebra-vo_mpc-1-1 --format fcd --out fcd

    \b
    Exit codes: 0 success, 2 bad input.
    """
    from cosim.errors import InputError
    from cosim.exchange.fcd import write_fcd
    from cosim.exchange.network import network_of
    from cosim.exchange.openscenario import write_openscenario
    from cosim.exchange.recorded import described

    description = described(folder)
    if kind not in FORMATS:
        raise InputError(f"--format: expected {' or '.join(FORMATS)}, got {kind!r}")
    if kind == "fcd":
        files = [write_fcd(folder, out)]
    elif encounter is None:
        raise InputError("--format openscenario: expected the encounter, for instance --encounter 1")
    else:
        there = (network or network_of(description)) if road else None
        files = write_openscenario(folder, encounter, there, out, traffic)
    for file in files:
        terminal.console().print(str(file), soft_wrap=True)
    return 0
