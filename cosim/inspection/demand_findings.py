"""Findings on vehicles, persons and route files."""

from __future__ import annotations

import shlex
from pathlib import Path

from cosim.inspection.demand import CAR, Demand
from cosim.inspection.finding import Finding, Level
from cosim.inspection.source import Source
from cosim.sumo.network import Network

LANE_CHANGE_MODEL = "lane-change model"


def vehicles(source: Source, demand: Demand) -> Finding:
    """Report the number of vehicles of each class in the demand."""
    present = {kind: count for kind, count in sorted(demand.vehicles.items()) if count >= 0.5}
    if not source.configured:
        return Finding("vehicles", Level.NOTE, "a network without a configuration has no demand")
    if not present:
        return Finding("vehicles", Level.NOTE, "none: an ego of --ego-route drives alone")
    parts = [f"{count:,.0f} {kind}" for kind, count in present.items()]
    if CAR not in present:
        return Finding(
            "vehicles", Level.NOTE, ", ".join(parts) + "; no cars that --ego-share could take over"
        )
    return Finding("vehicles", Level.GOOD, ", ".join(parts))


def persons(source: Source, demand: Demand) -> Finding:
    """Report the number of pedestrians."""
    if not source.configured:
        return Finding(
            "persons", Level.NOTE, "a network without a configuration has no demand; --scaffold adds some"
        )
    if demand.persons >= 0.5:
        return Finding("persons", Level.GOOD, f"{demand.persons:,.0f} in the demand")
    return Finding("persons", Level.MISSING, "none in the demand", _walks_command(source))


def sorting(demand: Demand) -> list[Finding]:
    """Name the route files of which SUMO drops entries; empty if it reads everything."""
    return [
        Finding(
            "route order",
            Level.DANGER,
            f"{path.name} is not sorted by time: SUMO drops {len(names)} entries, first {names[0]!r}",
            _sort_command(path),
        )
        for path, names in demand.ignored.items()
    ]


def unknown_names(demand: Demand) -> list[Finding]:
    """Name the first vehicle or person whose type or route is not defined."""
    if not demand.unknown:
        return []
    more = f" (and {len(demand.unknown) - 1} more like this)" if len(demand.unknown) > 1 else ""
    text = f"{demand.unknown[0]}{more}: SUMO stops when it reads this; define it above its first use"
    return [Finding("types and routes", Level.MISSING, text)]


def unknown_edges(demand: Demand, network: Network) -> list[Finding]:
    """Name the first person whose plan has an edge that does not exist."""
    unknown = [(edge, who) for edge, who in demand.walked.items() if edge not in network.edges]
    if not unknown:
        return []
    (edge, who), more = unknown[0], f" (and {len(unknown) - 1} more edges)" if len(unknown) > 1 else ""
    text = f"{who} goes along edge {edge!r}, which does not exist{more}: SUMO stops when it reads this"
    return [Finding("plans of persons", Level.MISSING, text)]


def lane_change_model(demand: Demand) -> list[Finding]:
    """Name the vehicle types with which hybrid actuation is not possible."""
    if not demand.lane_change_models:
        return []
    name, model = min(demand.lane_change_models.items())
    others = len(demand.lane_change_models) - 1
    more = f" and {others} more" if others else ""
    text = (
        f"vType {name!r}{more} has laneChangeModel {model}, which SUMO's sublane model excludes: "
        "cosim run --actuation move, or remove it"
    )
    return [Finding(LANE_CHANGE_MODEL, Level.NOTE, text)]


def closed_lanes(demand: Demand) -> list[Finding]:
    """Name lanes that are closed during the run; egos do not learn of this."""
    if not demand.closed:
        return []
    some = ", ".join(list(demand.closed)[:3]) + (", …" if len(demand.closed) > 3 else "")
    text = f"rerouters close {some}: egos drive there all the same, and SUMO's drivers do not see them there"
    return [Finding("closed lanes", Level.DANGER, text)]


def _walks_command(source: Source) -> str:
    return shlex.join(
        [
            *("python", "-m", "sumo.tools.randomTrips", "--net-file", str(source.net_file), "--pedestrians"),
            *("--begin", f"{source.begin_s:g}", "--end", f"{_end_s(source):g}", "--insertion-rate", "600"),
            *("--seed", "1", "--output-trip-file", f"{source.name}-persons.rou.xml"),
        ]
    )


def _end_s(source: Source) -> float:
    return source.begin_s + 3600.0 if source.end_s is None else source.end_s


def _sort_command(path: Path) -> str:
    name = path.name.removesuffix(".gz").removesuffix(".xml").removesuffix(".rou")
    return shlex.join(
        ["python", "-m", "sumo.tools.route.sort_routes", str(path), "--outfile", f"{name}-sorted.rou.xml"]
    )
