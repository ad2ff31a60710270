"""A town of twenty equal crossings, each on its own street, with or without one planted defect.

Streets do not meet, so that each is independent of the others, and all but the planted one are equal. The
town is a scenario folder of plain SUMO sources.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from analysis.files import write_text

STREETS = 20
PLANTED = 7
"""Number of the street with the defect, chosen arbitrarily."""
SPACING_M = 150.0
"""Distance between streets, beyond the distance to which vehicles are recorded from a crossing [m]."""
HALF_LENGTH_M = 90.0
STOP_LINE_M = 3.0
"""Distance from the stop line to the crossing [m]."""
LIMIT_MPS = 13.89
FASTER_MPS = 20.0 / 3.6
PEDESTRIANS_PER_H = 600.0
VEHICLES_PER_H = 400.0
"""Vehicles per hour in each direction."""


@dataclass(frozen=True, slots=True)
class Defect:
    """A defect of the planted crossing."""

    name: str
    meaning: str
    """Description on the page."""
    signals: bool = False
    """Whether all crossings of the town have signals."""
    limit_mps: float = LIMIT_MPS
    driver: str = ""
    """Further attributes of the vehicle type on the planted street."""
    clearance_s: float | None = None
    """Time from the end of the vehicles' green to the pedestrians' green there; ``None`` as elsewhere [s]."""


CLEARANCE_S, SHORT_S = 5.0, 1.0
"""Time from the vehicles' to the pedestrians' green: 3 s of yellow and 2 s of red, and one too short [s]."""
YELLOW_S, WALK_S, LEAVE_S, CYCLE_S = 3.0, 8.0, 9.0, 42.0
"""Vehicles' yellow, pedestrians' green, time for the last of them (7.2 m at 0.8 m/s), and the cycle [s]."""

DEFECTS = (
    Defect("nothing", "nothing is planted"),
    Defect(
        "no_yielding",
        "drivers do not yield (`jmIgnoreFoeProb` 1)",
        driver='jmIgnoreFoeProb="1" jmIgnoreFoeSpeed="100"',
    ),
    Defect(
        "faster",
        "the speed limit is 20 km/h higher (70 instead of 50 km/h)",
        limit_mps=LIMIT_MPS + FASTER_MPS,
    ),
    Defect(
        "sight",
        "a sight obstruction: drivers see no pedestrian before they are in the way (`jmCrossingGap` 0 m "
        "instead of 10 m)",
        driver='jmCrossingGap="0"',
    ),
    Defect(
        "clearance",
        f"a signal at which pedestrians get green {SHORT_S:g} s after the vehicles' green ends, instead of "
        f"{CLEARANCE_S:g} s",
        signals=True,
        clearance_s=SHORT_S,
    ),
)


def crossing_of(street: int) -> str:
    """Return the id that netconvert gives to the crossing of a street."""
    return f":crossing_{street}_c0"


def write_town(defect: Defect, folder: Path) -> Path:
    """Write the sources of the town with this defect; return the folder, which is a scenario."""
    folder.mkdir(parents=True, exist_ok=True)
    streets = range(1, STREETS + 1)
    nodes, edges, crossings, programs, demand = ([] for _ in range(5))
    for street in streets:
        planted = street == PLANTED
        nodes += _nodes(street, defect)
        edges += _edges(street, defect.limit_mps if planted else LIMIT_MPS)
        priority = "" if defect.signals else ' priority="true"'
        crossings.append(
            f'    <crossing node="crossing_{street}" edges="east_{street}_in west_{street}_out"'
            f'{priority} width="4.0"/>'
        )
        if defect.signals:
            chosen = defect.clearance_s if planted and defect.clearance_s is not None else CLEARANCE_S
            programs += _program(street, chosen)
        demand += _demand(street, "planted" if planted else "driver")
    types = [_vehicle_type("driver", ""), _vehicle_type("planted", defect.driver)]
    _write(folder / "nodes.nod.xml", "nodes", nodes)
    _write(folder / "edges.edg.xml", "edges", edges)
    _write(folder / "crossings.con.xml", "connections", crossings)
    _write(folder / "demand.rou.xml", "routes", [*types, *_WALKERS, *demand])
    _write(folder / "signals.add.xml", "additional", programs) if programs else None
    write_text(folder / "scenario.toml", _scenario(defect))
    return folder


def _write(path: Path, root: str, lines: Iterable[str]) -> None:
    text = "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', f"<{root}>", *lines, f"</{root}>", ""])
    write_text(path, text)


def _nodes(street: int, defect: Defect) -> list[str]:
    y = SPACING_M * street
    kind = "traffic_light" if defect.signals else "priority"
    return [
        f'    <node id="west_{street}" x="{-HALF_LENGTH_M:g}" y="{y:g}" type="priority"/>',
        f'    <node id="crossing_{street}" x="0" y="{y:g}" type="{kind}"/>',
        f'    <node id="east_{street}" x="{HALF_LENGTH_M:g}" y="{y:g}" type="priority"/>',
    ]


def _edges(street: int, limit: float) -> list[str]:
    way = {
        "east": [f"west_{street}", f"crossing_{street}", f"east_{street}"],
        "west": [f"east_{street}", f"crossing_{street}", f"west_{street}"],
    }
    return [
        f'    <edge id="{direction}_{street}_{part}" from="{nodes[at]}" to="{nodes[at + 1]}" numLanes="1" '
        f'speed="{limit:.2f}" sidewalkWidth="2.5"><stopOffset value="{STOP_LINE_M:g}"/></edge>'
        for direction, nodes in way.items()
        for at, part in enumerate(("in", "out"))
    ]


def _vehicle_type(name: str, attributes: str) -> str:
    return (
        f'    <vType id="{name}" vClass="passenger" length="4.5" width="1.8" minGap="2.0" accel="2.0" '
        f'decel="2.0" emergencyDecel="8.0" tau="1.1" sigma="0.3" '
        f'speedFactor="normc(1.00,0.10,0.80,1.25)" {attributes}/>'
    )


_WALKERS = [
    '    <vType id="walker" vClass="pedestrian" length="0.5" width="0.5" desiredMaxSpeed="1.4" '
    'speedFactor="normc(1.00,0.17,0.60,1.60)"/>'
]


def _demand(street: int, driver: str) -> list[str]:
    flows = [
        f'    <flow id="{direction}_{street}" type="{driver}" begin="0" end="$end_s" period="exp($vehicles)" '
        f'from="{direction}_{street}_in" to="{direction}_{street}_out" departSpeed="desired"/>'
        for direction in ("east", "west")
    ]
    for name, start, end in (("north", "east", "west"), ("south", "west", "east")):
        flows += [
            f'    <personFlow id="{name}_{street}" type="walker" begin="0" end="$end_s" '
            f'period="exp($pedestrians)" departPos="-15">',
            f'        <walk from="{start}_{street}_in" to="{end}_{street}_out" arrivalPos="15"/>',
            "    </personFlow>",
        ]
    return flows


def _program(street: int, clearance_s: float) -> list[str]:
    """Return a street's signal program: vehicles, then pedestrians; the cycle is equal on all streets."""
    yellow = min(YELLOW_S, clearance_s)
    phases = (
        (CYCLE_S - clearance_s - WALK_S - LEAVE_S, "GGr"),
        (yellow, "yyr"),
        (clearance_s - yellow, "rrr"),
        (WALK_S, "rrG"),
        (LEAVE_S, "rrr"),
    )
    return [
        f'    <tlLogic id="crossing_{street}" type="static" programID="planted" offset="0">',
        *(
            f'        <phase duration="{duration:g}" state="{state}"/>'
            for duration, state in phases
            if duration
        ),
        "    </tlLogic>",
    ]


def _scenario(defect: Defect) -> str:
    routes = '"demand.rou.xml"'
    additional = '["signals.add.xml"]' if defect.signals else "[]"
    return f"""description = "Twenty equal crossings; planted: {defect.name}"
duration_s = 140.0
warmup_s = 20.0
step_s = 0.2

[network]
nodes = "nodes.nod.xml"
edges = "edges.edg.xml"
connections = ["crossings.con.xml"]

[demand]
routes = [{routes}]
additional = {additional}
vehicles_per_hour = {VEHICLES_PER_H}     # per direction
pedestrians_per_hour = {PEDESTRIANS_PER_H}  # per crossing, both directions together

[rates]
vehicles = {{ of = "vehicles_per_hour", share = 1.0 }}
pedestrians = {{ of = "pedestrians_per_hour", share = 0.5 }}
"""
