"""Small networks made by netconvert: three roads that meet, as SUMO makes them without being told more."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import sumo

NODES = (("a", 0, 0), ("b", 200, 0), ("c", 400, 0), ("d", 200, 200))
ROADS = (("east_1", "a", "b"), ("west_2", "b", "a"), ("east_2", "b", "c"), ("west_1", "c", "b"))
SIDE_ROAD = (("north", "b", "d"), ("south", "d", "b"))
WALKS = ("--sidewalks.guess", "--sidewalks.guess.max-speed", "13.9")
CROSSINGS = ("--crossings.guess", "--crossings.guess.speed-threshold", "13.9")
CARS = '<flow id="cars" begin="0" end="300" vehsPerHour="360" from="east_1" to="east_2"/>'
PERSONS = (
    '<personFlow id="walkers" begin="0" end="300" period="10"><walk from="east_1" to="west_2"/></personFlow>'
)


def build(folder: Path, *options: str, lanes: int = 2, junction: bool = True) -> Path:
    """Build a network of three arms, or of one straight road, and return its file."""
    nodes = "".join(f'<node id="{name}" x="{x}" y="{y}"/>' for name, x, y in NODES)
    roads = (*ROADS, *(SIDE_ROAD if junction else ()))
    edges = "".join(
        f'<edge id="{name}" from="{start}" to="{end}" numLanes="{lanes}" speed="13.9"/>'
        for name, start, end in roads
    )
    (folder / "n.nod.xml").write_text(f"<nodes>{nodes}</nodes>")
    (folder / "e.edg.xml").write_text(f"<edges>{edges}</edges>")
    call("netconvert", "-n", "n.nod.xml", "-e", "e.edg.xml", *options, "-o", "town.net.xml", folder=folder)
    return folder / "town.net.xml"


def configure(folder: Path, demand: str = "", options: str = "", step: str = "0.1") -> Path:
    """Write a configuration of the network in a folder, and return its file."""
    (folder / "town.rou.xml").write_text(f"<routes>{demand}</routes>")
    path = folder / "town.sumocfg"
    path.write_text(
        '<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>'
        f'<time><end value="300"/><step-length value="{step}"/></time>{options}</configuration>'
    )
    return path


def call(*command: str, folder: Path) -> None:
    """Run a command as a user would in that folder, with the programs of the installed SUMO."""
    program = Path(sumo.SUMO_HOME) / "bin" / command[0]
    first = sys.executable if command[0] == "python" else str(program)
    subprocess.run([first, *command[1:]], cwd=folder, check=True, capture_output=True)


def call_line(line: str, folder: Path) -> None:
    """Run a command line."""
    call(*shlex.split(line), folder=folder)
