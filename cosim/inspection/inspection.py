"""Makes all checks of a network and its demand, and gives the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cosim.inspection import crossings, demand_findings, geometry, options, roads
from cosim.inspection.crossings import Counts
from cosim.inspection.demand import Demand, read_demand
from cosim.inspection.ego_routes import EgoRoute, passing, suggest
from cosim.inspection.finding import Finding, Level
from cosim.inspection.source import Source, read_source
from cosim.inspection.ways import Ways
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network


@dataclass(frozen=True, slots=True)
class Inspection:
    """The findings on a network and its demand."""

    source: Source
    network: Network
    demand: Demand
    counts: Counts
    """Crossings by kind and lanes crossed."""
    routes: tuple[EgoRoute, ...]
    findings: tuple[Finding, ...]

    @property
    def possible(self) -> bool:
        """Whether the network supports a pedestrian study."""
        return all(finding.level is not Level.MISSING for finding in self.findings)

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        missing = [finding.check for finding in self.findings if finding.level is Level.MISSING]
        if missing:
            return f"a pedestrian study cannot be run here yet: see {', '.join(missing)}"
        beware = [finding.check for finding in self.findings if finding.level is Level.DANGER]
        care = f", but see {', '.join(dict.fromkeys(beware))}" if beware else ""
        return f"a pedestrian study can be run here{care}"


def inspect(path: Path) -> Inspection:
    """Inspect a network or a SUMO configuration.

    Raises
    ------
    InputError
        If the file, or a file that it names, is missing or invalid.
    """
    return inspect_source(read_source(path))


def crossing_ids(path: Path) -> frozenset[str]:
    """Return the ids of the crossings of a network, or of the network of a SUMO configuration.

    Raises
    ------
    InputError
        As for `inspect`.
    """
    return frozenset(read_network(read_source(path).net_file).crossings)


def inspect_source(source: Source) -> Inspection:
    """Inspect a network and the demand that goes with it.

    Raises
    ------
    InputError
        If a file is invalid.
    """
    network = read_network(source.net_file)
    demand = read_demand(source)
    ways = Ways(network)
    counts = crossings.counted(ways)
    routes = tuple(suggest(ways))
    cars = passing(ways, demand) if source.configured else None
    findings = (
        roads.roads(network),
        roads.sidewalks(network, source.net_file),
        roads.permissions(network),
        crossings.crossings(network, counts, source.net_file),
        *geometry.waiting_places(network),
        *geometry.tight_bends(network),
        *geometry.swept_walking_areas(network),
        crossings.ego_routes(routes, cars, bool(counts)),
        *crossings.impossible_routes(cars),
        demand_findings.vehicles(source, demand),
        demand_findings.persons(source, demand),
        *demand_findings.sorting(demand),
        *demand_findings.unknown_names(demand),
        *demand_findings.unknown_edges(demand, network),
        *demand_findings.lane_change_model(demand),
        *demand_findings.closed_lanes(demand),
        options.step_length(source),
        *options.pedestrian_model(source),
        *options.mesoscopic(source),
        *options.route_errors(source),
        *options.replaced(source),
    )
    return Inspection(source, network, demand, counts, routes, findings)
