"""A small network, a running simulation, and functions that observe vehicles."""

from __future__ import annotations

import importlib
import math
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from multiprocessing.util import Finalize
from pathlib import Path
from typing import Any

from cosim.conformance.track import Pose
from cosim.errors import SimulationError
from cosim.step.frames import heading_of
from cosim.sumo.connection import start

OPTIONS = ("--time-to-teleport", "-1", "--no-step-log", "true", "--no-warnings", "true", "--seed", "1")
COLLISION_OPTIONS = (
    *("--collision.action", "warn"),
    *("--collision.check-junctions", "true"),
    *("--collision.mingap-factor", "0"),
)
"""Options of the cases themselves, so that a change elsewhere does not change what the cases measure."""

NETS = Path(__file__).parent / "nets"

TYPES = """
<vType id="ego" length="4.5" width="1.8" minGap="2.5" sigma="0" speedFactor="1" maxSpeed="30"/>
<vType id="car" length="4.5" width="1.8" minGap="2.5" sigma="0" speedFactor="1" maxSpeed="30"/>
<vType id="walker" vClass="pedestrian" speedFactor="1" maxSpeed="1.3"/>
"""


@contextmanager
def scene(
    net: str,
    traffic: str,
    *extra: str,
    step: float = 0.1,
    sublane: bool = True,
    additional: str = "",
    collision_options: bool = True,
) -> Iterator[Any]:
    """Run SUMO on one of the nets of this package and yield the libsumo module.

    Parameters
    ----------
    net : name of the network's plain XML files in ``nets``
    traffic : routes, vehicles and persons as XML, in addition to the types ``ego``, ``car`` and ``walker``
    extra : further options of SUMO
    step : step length [s]
    sublane : run SUMO's sublane model
    additional : further elements as XML, such as detectors
    """
    with tempfile.TemporaryDirectory(prefix="cosim-conformance-") as name:
        folder = Path(name)
        network = _built(net)
        routes = folder / "traffic.rou.xml"
        routes.write_text(f"<routes>{TYPES}{traffic}</routes>")
        options = ["--net-file", str(network), "--route-files", str(routes)]
        if additional:
            file = folder / "more.add.xml"
            file.write_text(f"<additional>{additional}</additional>")
            options += ["--additional-files", str(file)]
        options += ["--step-length", str(step), *OPTIONS]
        options += COLLISION_OPTIONS if collision_options else ()
        options += ["--lateral-resolution", "0.4"] if sublane else []
        options += extra
        connection = start(options)
        try:
            yield connection.sumo
        finally:
            connection.close()


def _built(net: str) -> Path:
    """Return the file of a net; make it unless a process with the same folder has already done so."""
    place = _Nets.folder or nets_folder()
    found = place / f"{net}.net.xml"
    if not found.exists():
        with tempfile.TemporaryDirectory(dir=place) as unfinished:
            build(net, Path(unfinished)).replace(found)
    return found


class _Nets:
    folder: Path | None = None
    """Folder of nets that another process shares with this one."""


def use_nets(folder: Path) -> None:
    """Share the folder of nets with another process: read nets from it and write new ones to it."""
    _Nets.folder = folder


@cache
def nets_folder() -> Path:
    """Return the folder of this process's nets; it is deleted when the process ends."""
    folder = Path(tempfile.mkdtemp(prefix="cosim-nets-"))
    Finalize(None, shutil.rmtree, (folder, True), exitpriority=0)
    return folder


def build(net: str, folder: Path) -> Path:
    """Make one of the nets with netconvert and return its file."""
    output = folder / f"{net}.net.xml"
    command = [tool("netconvert"), "--no-turnarounds", "true", "--output-file", str(output)]
    for option, kind in (("--node-files", "nod"), ("--edge-files", "edg"), ("--connection-files", "con")):
        source = NETS / f"{net}.{kind}.xml"
        if source.exists():
            command += [option, str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SimulationError(f"netconvert cannot build {net}: {' '.join(done.stderr.split())}")
    return output


def tool(name: str) -> str:
    """Return the path of one of SUMO's programs."""
    found = shutil.which(name, path=str(sumo_home() / "bin")) or shutil.which(name)
    if found is None:
        raise SimulationError(f"{name} was not found; it comes with the package eclipse-sumo")
    return found


def sumo_home() -> Path:
    """Return where the package eclipse-sumo is installed."""
    return Path(importlib.import_module("sumo").SUMO_HOME)


def wait_for(sumo: Any, name: str, limit: float = 60.0) -> None:
    """Step until a vehicle is on the road."""
    while name not in sumo.vehicle.getIDList() or not sumo.vehicle.getLaneID(name):
        if sumo.simulation.getTime() > limit:
            raise SimulationError(f"{name} was not inserted within {limit:.0f} s")
        sumo.simulationStep()


def pose_of(sumo: Any, name: str) -> Pose:
    """Return a vehicle's pose in SUMO."""
    x, y = sumo.vehicle.getPosition(name)
    return Pose(x, y, heading_of(sumo.vehicle.getAngle(name)), sumo.vehicle.getSpeed(name))


Rectangle = tuple[float, float, float, float, float]
"""Front bumper x, y [m], heading [rad], length, width [m]."""


def rectangle(sumo: Any, name: str) -> Rectangle:
    """Return a vehicle's body in SUMO."""
    vehicle = sumo.vehicle
    x, y = vehicle.getPosition(name)
    return x, y, heading_of(vehicle.getAngle(name)), vehicle.getLength(name), vehicle.getWidth(name)


def separation(one: Rectangle, other: Rectangle) -> float:
    """Return the distance between two rectangles [m]; a negative value is the depth of their overlap."""
    first, second = _corners(one), _corners(other)
    gap = -math.inf
    for heading in (one[2], one[2] + 0.5 * math.pi, other[2], other[2] + 0.5 * math.pi):
        east, north = math.cos(heading), math.sin(heading)
        a = [x * east + y * north for x, y in first]
        b = [x * east + y * north for x, y in second]
        gap = max(gap, min(b) - max(a), min(a) - max(b))
    if gap <= 0.0:
        return gap
    return min(
        min(_to_segment(point, second[i - 1], second[i]) for point in first for i in range(4)),
        min(_to_segment(point, first[i - 1], first[i]) for point in second for i in range(4)),
    )


def _corners(body: Rectangle) -> list[tuple[float, float]]:
    x, y, heading, length, width = body
    east, north = math.cos(heading), math.sin(heading)
    half = 0.5 * width
    return [
        (x - back * east - side * north, y - back * north + side * east)
        for back, side in ((0.0, half), (0.0, -half), (length, -half), (length, half))
    ]


def _to_segment(
    point: tuple[float, float], start_point: tuple[float, float], end_point: tuple[float, float]
) -> float:
    east, north = end_point[0] - start_point[0], end_point[1] - start_point[1]
    square = east * east + north * north
    share = ((point[0] - start_point[0]) * east + (point[1] - start_point[1]) * north) / square
    share = min(1.0, max(0.0, share))
    return math.dist(point, (start_point[0] + share * east, start_point[1] + share * north))
