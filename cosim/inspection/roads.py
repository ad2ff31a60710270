"""Findings on roads, sidewalks and their permissions."""

from __future__ import annotations

import shlex
from pathlib import Path

from cosim.inspection.finding import Finding, Level
from cosim.inspection.ways import CAR
from cosim.sumo.network import NetLane, Network

ON_FOOT = "pedestrian"
_TOWN_SPEED_MPS = 19.5
"""Speed limit up to which the suggested command gives roads a sidewalk: 70 km/h [m/s]."""


def car_edges(network: Network) -> list[str]:
    """Return the edges that passenger cars may use."""
    return [edge for edge in network.roads if network.allowed_lanes(edge, CAR)]


def is_sidewalk(lane: NetLane) -> bool:
    """Return whether people walk on a lane and cars do not drive on it."""
    return lane.permissions.allows(ON_FOOT) and not lane.permissions.allows(CAR)


def any_sidewalk(network: Network) -> bool:
    """Return whether there is a sidewalk anywhere."""
    return any(is_sidewalk(lane) for lane in network.lanes.values() if not lane.internal)


def roads(network: Network) -> Finding:
    """Report how many edges are for cars, and how many of these have several lanes."""
    edges = car_edges(network)
    several = [edge for edge in edges if len(network.allowed_lanes(edge, CAR)) > 1]
    if not edges:
        return Finding("roads", Level.MISSING, f"no edge for cars among {len(network.roads)}")
    text = f"{len(edges)} of {len(network.roads)} edges are for cars; {len(several)} have more than one lane"
    if not several:
        return Finding("roads", Level.NOTE, text + ": no lane changes")
    return Finding("roads", Level.GOOD, text)


def sidewalks(network: Network, net_file: Path) -> Finding:
    """Report how many roads have a sidewalk."""
    edges = car_edges(network)
    with_one = [edge for edge in edges if any(map(is_sidewalk, _lanes(network, edge)))]
    alone = [edge for edge in network.roads if edge not in edges and _has_walkers(network, edge)]
    text = f"{len(with_one)} of {len(edges)} edges for cars have one; {len(alone)} edges are footpaths"
    if not with_one and not alone:
        return Finding("sidewalks", Level.MISSING, "none", guess_command(network, net_file, sidewalks=True))
    return Finding("sidewalks", Level.GOOD if with_one else Level.NOTE, text)


def permissions(network: Network) -> Finding:
    """Report edges on which people walk on the lanes of cars."""
    edges = car_edges(network)
    shared = [
        edge
        for edge in edges
        if not any(map(is_sidewalk, _lanes(network, edge)))
        and any(lane.permissions.allows(ON_FOOT) for lane in _lanes(network, edge))
    ]
    nobody = [edge for edge in edges if not _has_walkers(network, edge)]
    text = f"{len(nobody)} edges for cars are closed to pedestrians"
    if shared:
        return Finding(
            "permissions",
            Level.NOTE,
            f"on {len(shared)} of {len(edges)} edges for cars, pedestrians walk on the carriageway; {text}",
        )
    return Finding("permissions", Level.GOOD, f"pedestrians and cars share no lane; {text}")


def guess_command(network: Network, net_file: Path, sidewalks: bool) -> str:
    """Return the netconvert command that adds crossings and, with ``sidewalks``, sidewalks."""
    return shlex.join(
        [
            *("netconvert", "--sumo-net-file", str(net_file)),
            *guess_options(network, sidewalks),
            *("--output-file", with_crossings(net_file)),
        ]
    )


def guess_options(network: Network, sidewalks: bool) -> list[str]:
    """Return the options of that command that control what netconvert guesses."""
    speeds = sorted(network.lanes[network.edges[edge][-1]].speed for edge in car_edges(network)) or [13.89]
    speed = max([one for one in speeds if one <= _TOWN_SPEED_MPS] or speeds)
    walks = ["--sidewalks.guess", "--sidewalks.guess.max-speed", f"{speed:g}"] if sidewalks else []
    # Crossings lie inside junctions, which netconvert leaves empty if they are so in the network.
    inside = any(lane.internal for lane in network.lanes.values())
    junctions = [] if inside else ["--no-internal-links", "false"]
    return [*walks, "--crossings.guess", "--crossings.guess.speed-threshold", f"{speed:g}", *junctions]


def with_crossings(net_file: Path) -> str:
    """Return the file name of a network once it has crossings.

    >>> with_crossings(Path("a/town.net.xml.gz"))
    'town-crossings.net.xml'
    """
    name = net_file.name.removesuffix(".gz").removesuffix(".net.xml").removesuffix(".xml")
    return f"{name}-crossings.net.xml"


def _lanes(network: Network, edge: str) -> list[NetLane]:
    return [network.lanes[name] for name in network.edges[edge]]


def _has_walkers(network: Network, edge: str) -> bool:
    return bool(network.allowed_lanes(edge, ON_FOOT))
