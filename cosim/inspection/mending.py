"""Adds missing crossings and sidewalks to a network, and fits the demand to it."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from cosim.errors import InputError
from cosim.inspection.carry_over import CarryOver
from cosim.inspection.inspection import Inspection, inspect_source
from cosim.inspection.roads import any_sidewalk, car_edges, guess_command, guess_options, with_crossings
from cosim.sumo.network_file import read_network
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.file_names import plain_name
from sumo_scenarios.sumo_installation import netconvert, sumo_home

_COMMENT = re.compile(rb"<!--.*?-->\s*", re.DOTALL)


def mend(found: Inspection, work: Path, folder: Path) -> tuple[Inspection, list[str]]:
    """Let netconvert guess crossings; return the inspection of the result, and lines that say what was done.

    Parameters
    ----------
    found : inspection of a network without crossings
    work : folder to which the network and the copies of files are written
    folder : folder in which they will be read

    Raises
    ------
    InputError
        If netconvert refuses the network, or there is no road in it.
    """
    source = found.source
    if not car_edges(found.network):
        return found, []
    net = work / with_crossings(source.net_file)
    sidewalks = not any_sidewalk(found.network)
    _guess(source.net_file, guess_options(found.network, sidewalks), net)
    carrier = CarryOver(found.network, read_network(net), folder)
    additional = _copies(carrier, source.additional_files, work / "additional", "additional")
    routes = _copies(carrier, source.route_files, work / "routes", "routes")
    mended = replace(source, net_file=net, additional_files=additional, route_files=routes)
    said = [
        f"fixed by: {guess_command(found.network, source.net_file, sidewalks)}",
        *carrier.carried.lines(),
    ]
    return inspect_source(mended), said


def _copies(carrier: CarryOver, paths: Iterable[Path], work: Path, root: str) -> tuple[Path, ...]:
    found = []
    for number, path in enumerate(paths):
        target = work / str(number) / path.name.removesuffix(".gz")
        target.parent.mkdir(parents=True)
        carrier.write(path, target, root)
        found.append(target)
    return tuple(found)


def _guess(net_file: Path, options: Iterable[str], target: Path) -> None:
    """Write the network with crossings, without netconvert's comment, which contains the date and paths."""
    try:
        program = netconvert()
        environment = {**os.environ, "SUMO_HOME": str(sumo_home())}
    except ScenarioError as error:
        raise InputError(f"--scaffold: {error}") from error
    with TemporaryDirectory(prefix="cosim-") as links:
        net = plain_name(net_file, Path(links))
        command = [str(program), "--sumo-net-file", net, *options, "--xml-validation", "never"]
        command += ["--output-file", str(target)]
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    if result.returncode != 0 or not target.is_file():
        reasons = [line for line in result.stderr.splitlines() if line.startswith("Error")]
        reason = " ".join(reasons) or f"it ended with {result.returncode}"
        raise InputError(f"--scaffold: netconvert cannot add crossings to {net_file}: {reason}")
    target.write_bytes(_COMMENT.sub(b"", target.read_bytes()))
