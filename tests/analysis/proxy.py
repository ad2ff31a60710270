"""SUMO as a judge: a small vehicle in place of the pedestrian, watched by the ego's SSM device.

``python -m tests.analysis.proxy`` prints the agreement table of docs/judges.md.
"""

from __future__ import annotations

import math
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import libsumo
import numpy as np
import sumo

from analysis.encounters.case import Case, prepare
from analysis.markdown import table
from analysis.recording.reading import read_run
from analysis.thresholds import Thresholds
from tests.analysis.recorded import Ego, Motion, Person, write_run
from tests.analysis.ssm import SsmConflict, read_ssm

STEP = 0.1
CAR_LENGTH, CAR_WIDTH = 4.5, 1.8

_NODES = """<nodes><node id="w" x="-200" y="0"/><node id="e" x="200" y="0"/><node id="s" x="0" y="-100"/>
<node id="n" x="0" y="100"/><node id="c" x="0" y="0" type="priority"/></nodes>"""
_EDGES = """<edges><edge id="wc" from="w" to="c" priority="3" speed="20"/>
<edge id="ce" from="c" to="e" priority="3" speed="20"/><edge id="sc" from="s" to="c" priority="1" speed="20"/>
<edge id="cn" from="c" to="n" priority="1" speed="20"/></edges>"""
_CONNECTIONS = """<connections><connection from="wc" to="ce"/><connection from="sc" to="cn"/></connections>"""
_SSM = "".join(
    f'<param key="{key}" value="{value}"/>'
    for key, value in {
        "has.ssm.device": "true",
        "device.ssm.measures": "TTC DRAC PET",
        "device.ssm.thresholds": "20.0 0.0 20.0",
        "device.ssm.range": "150",
        "device.ssm.extratime": "10",
        "device.ssm.trajectories": "true",
    }.items()
)


@dataclass(frozen=True)
class Foe:
    """The vehicle in place of the pedestrian; a square, so that a disc of its width fits."""

    size: float = 0.5
    speed: float = 1.4
    position: float = 74.0
    ahead_of_ego: bool = False
    """On the ego's own road instead of the one that crosses it."""


def build(folder: Path) -> Path:
    """Build the two crossing roads and return the net."""
    net = folder / "net.xml"
    texts = {"nodes.xml": _NODES, "edges.xml": _EDGES, "connections.xml": _CONNECTIONS}
    for name, text in texts.items():
        (folder / name).write_text(text)
    netconvert = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    files = ("-n", "nodes.xml", "-e", "edges.xml", "-x", "connections.xml", "-o", net.name)
    subprocess.run([str(netconvert), *files], cwd=folder, check=True, capture_output=True)
    return net


def drive(folder: Path, net: Path, foe: Foe, ego_speed: float = 10.0) -> tuple[Case, list[SsmConflict]]:
    """Drive ego and foe at constant speed; return our case of the recording and SUMO's conflicts."""
    ssm = folder / "ssm.xml"
    route = "wc ce" if foe.ahead_of_ego else "sc cn"
    (folder / "routes.xml").write_text(
        f"""<routes><vType id="car" length="{CAR_LENGTH}" width="{CAR_WIDTH}" sigma="0" maxSpeed="30"/>
<vType id="foe" length="{foe.size}" width="{foe.size}" minGap="0.1" sigma="0" maxSpeed="30"/>
<vehicle id="foe" type="foe" depart="0" departPos="{foe.position}" departSpeed="{foe.speed}">
<route edges="{route}"/></vehicle>
<vehicle id="ego" type="car" depart="0" departPos="20" departSpeed="{ego_speed}"><route edges="wc ce"/>
{_SSM}<param key="device.ssm.file" value="{ssm}"/></vehicle></routes>"""
    )
    seen = _simulate(net, folder / "routes.xml", {"ego": ego_speed, "foe": foe.speed})
    times = sorted(seen["ego"].keys() & seen["foe"].keys())
    ego = Ego(_motion(seen["ego"], CAR_LENGTH), start=times[0], end=times[-1], width=CAR_WIDTH)
    person = Person(
        _motion(seen["foe"], foe.size), start=times[0], end=times[-1], radius=0.5 * foe.size, crossing=None
    )
    write_run(folder / "run", [ego], [person], step=STEP, duration=times[-1], areas=())
    wide = Thresholds(encounter_range_m=400.0)
    return prepare(read_run(folder / "run"), wide), read_ssm(ssm)


def _simulate(
    net: Path, routes: Path, speeds: dict[str, float]
) -> dict[str, dict[float, tuple[float, float, float]]]:
    """Return name -> time -> front bumper and heading [rad]; the time is that of SUMO's SSM device."""
    command = ["sumo", "-n", str(net), "-r", str(routes), "--step-length", str(STEP), "--no-step-log", "true"]
    seen: dict[str, dict[float, tuple[float, float, float]]] = {name: {} for name in speeds}
    libsumo.start(
        [*command, "--collision.action", "none", "--time-to-teleport", "-1", "--no-warnings", "true"]
    )
    try:
        for step in range(330):
            libsumo.simulationStep()
            for name in set(speeds) & set(libsumo.vehicle.getIDList()):
                libsumo.vehicle.setSpeedMode(name, 32)
                libsumo.vehicle.setSpeed(name, speeds[name])
                x, y = libsumo.vehicle.getPosition(name)
                seen[name][round(step * STEP, 6)] = x, y, math.radians(90 - libsumo.vehicle.getAngle(name))
    finally:
        libsumo.close()
    return seen


def _motion(seen: dict[float, tuple[float, float, float]], length: float) -> Motion:
    """Return the motion of the body's centre, straight between the recorded instants."""
    times = np.array(sorted(seen))
    rows = np.array([seen[time] for time in times])
    x = rows[:, 0] - 0.5 * length * np.cos(rows[:, 2])
    y = rows[:, 1] - 0.5 * length * np.sin(rows[:, 2])

    def at(t: float) -> tuple[float, float]:
        return _line(t, times, x), _line(t, times, y)

    return at


def _line(t: float, times: np.ndarray, values: np.ndarray) -> float:
    k = int(np.clip(np.searchsorted(times, t) - 1, 0, len(times) - 2))
    slope = (values[k + 1] - values[k]) / (times[k + 1] - times[k])
    return float(values[k] + slope * (t - times[k]))


def post_encroachment_differences(folder: Path, net: Path, foes: list[Foe]) -> list[float]:
    """Return our area PET minus SUMO's, for each foe [s]."""
    found = []
    for number, foe in enumerate(foes):
        place = folder / f"pet{number}"
        place.mkdir()
        case, conflicts = drive(place, net, foe)
        (own,) = case.post_encroachment()
        (judged,) = [one.pet.value for one in conflicts if one.pet is not None]
        found.append(float(own - judged))
    return found


def time_to_collision_differences(folder: Path, net: Path, foe: Foe) -> np.ndarray:
    """Return our TTC minus SUMO's at every step where both have one above 0 [s]."""
    case, (conflict,) = drive(folder, net, foe)
    samples = case.samples
    at = np.searchsorted(samples.time, conflict.times - 1e-6)
    inside = at < len(samples)
    inside[inside] = np.abs(samples.time[at[inside]] - conflict.times[inside]) < 1e-6
    own, judged = samples.ttc[at[inside]], conflict.ttc[inside]
    both = np.isfinite(own) & np.isfinite(judged) & (own > 0.0) & (judged > 0.0)
    assert both.sum() >= 20, "too few steps with a collision course"
    return own[both] - judged[both]


PET_FOES = [
    *(Foe(position=position) for position in (76.0, 78.0, 80.0, 82.0, 84.0)),
    *(Foe(position=position, size=0.4, speed=2.0) for position in (60.0, 64.0)),
]
WIDE_FOES = [Foe(position=position, size=1.8, speed=5.0) for position in (20.0, 30.0, 35.0)]
COURSE = Foe(position=74.0)
SIDE = Foe(position=71.9)
LEADER = Foe(position=60.0, speed=6.0, size=1.8, ahead_of_ego=True)


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        net = build(folder)
        rows: list[tuple[str, np.ndarray]] = []
        for title, foes in (("pedestrian proxy", PET_FOES), ("vehicle 1.8 x 1.8 m", WIDE_FOES)):
            place = folder / title.replace(" ", "")
            place.mkdir()
            rows.append((f"area PET, {title}", np.array(post_encroachment_differences(place, net, foes))))
        for title, foe in (("front", COURSE), ("side", SIDE), ("following a vehicle", LEADER)):
            place = folder / title.replace(" ", "")
            place.mkdir()
            rows.append((f"TTC at each step, {title}", time_to_collision_differences(place, net, foe)))
    sizes = [(title, np.abs(difference)) for title, difference in rows]
    cells = [(title, str(len(size)), f"{size.max():.4f} s", f"{size.mean():.4f} s") for title, size in sizes]
    print(table(("measure", "cases", "largest difference", "mean difference"), cells))


if __name__ == "__main__":
    main()
