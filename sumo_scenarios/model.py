"""What a scenario is: frozen values that a run is made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.pedestrian_tables import PedestrianTable, read_pedestrians
from sumo_scenarios.schema import Actuation, ParameterValue, ScenarioTable

HYBRID_LATERAL_RESOLUTION_M = 0.4
NEVER = -1.0
"""Of SUMO's time-to-teleport."""


@dataclass(frozen=True, slots=True)
class Egos:
    """How egos come about: inserted trips, vehicles taken over by id, or a share of passenger cars."""

    routes: tuple[tuple[str, ...], ...] = ()
    """Edge ids, one ego trip each, taken in turn until there are ``count`` egos."""
    vehicles: tuple[str, ...] = ()
    """Ids of vehicles of the demand to take over."""
    share: float | None = None
    """Share of the demand's passenger cars to take over, in [0, 1]; which ones is drawn by the seed."""
    count: int = 0
    """Number of inserted egos."""
    first_depart_s: float = 0.0
    """Time from the end of the warm-up to the first insertion [s]."""
    headway_s: float = 30.0
    """Time between insertions [s]."""
    vehicle_type: str = ""
    """SUMO vType of inserted egos; empty for the tool's own passenger car."""
    depart_lane: str = "best"
    depart_speed: str = "desired"


@dataclass(frozen=True, slots=True)
class Scenario:
    """A road, its demand, and who in it is an ego."""

    name: str
    folder: Path | None
    """Where scenario.toml is; ``None`` for a configuration of the user's own."""
    sumocfg: Path | None
    """Configuration used in place; ``None`` where the network is built from plain sources."""
    description: str
    begin_s: float
    """Simulated time of the first step [s]; 54000 is 15:00."""
    duration_s: float
    """Simulated time from the first step to the end, warm-up included [s]."""
    warmup_s: float
    """Time after which egos come in and recording starts [s]."""
    step_s: float
    actuation: Actuation
    lateral_resolution_m: float | None
    """Of SUMO's sublane model; ``None`` leaves the configuration's own lane-change model [m]."""
    vehicles_per_hour: float | None
    """``None`` where the demand is not ours; the scenario's README says per what."""
    pedestrians_per_hour: float | None
    parameters: Mapping[str, ParameterValue]
    """Further parameters of this scenario."""
    egos: Egos
    teleport_after_s: float = NEVER
    """How long a vehicle of SUMO's stands before SUMO puts it elsewhere; not positive: for ever [s]."""
    table: ScenarioTable | None = None
    """What scenario.toml says."""
    pedestrians: tuple[PedestrianTable, ...] = ()
    """Scripted ones, whom SUMO does not have."""
    variant: Path | None = None
    """Folder of the scenario.toml that has a base; ``folder`` is that of the base then."""
    pedestrians_in: Path | None = None
    """Folder of the scenario.toml whose scripted pedestrians these are; ``None``: ``folder``."""


def egos_of(table: ScenarioTable, parameters: Mapping[str, ParameterValue]) -> Egos:
    """Return the egos of a scenario.toml for these values of its parameters."""
    egos = table.egos
    return Egos(
        routes_of(table, parameters),
        tuple(egos.vehicles),
        egos.share,
        egos.count,
        egos.first_depart_s,
        egos.headway_s,
        egos.vehicle_type,
        egos.depart_lane,
        egos.depart_speed,
    )


def routes_of(table: ScenarioTable, parameters: Mapping[str, ParameterValue]) -> tuple[tuple[str, ...], ...]:
    """Return the ego trips whose ``when`` holds for these parameters."""
    return tuple(
        tuple(route.edges.split())
        for route in table.egos.routes
        if all(parameters[key] == value for key, value in route.when.items())
    )


def with_pedestrians(scenario: Scenario) -> Scenario:
    """Return the scenario with its scripted pedestrians as its present parameters make them.

    Raises
    ------
    ScenarioError
        One line with file, row and key.
    """
    if scenario.table is None or scenario.folder is None or not scenario.table.pedestrians:
        return scenario
    demand = {key: getattr(scenario, key) for key in ("vehicles_per_hour", "pedestrians_per_hour")}
    values = {key: value for key, value in demand.items() if value is not None} | dict(scenario.parameters)
    path = (scenario.pedestrians_in or scenario.folder) / "scenario.toml"
    return replace(scenario, pedestrians=read_pedestrians(scenario.table.pedestrians, values, path))


def with_egos(
    scenario: Scenario,
    route: Sequence[str] = (),
    vehicle: Sequence[str] = (),
    share: float | None = None,
) -> Scenario:
    """Return the scenario with other egos: one trip along ``route``, vehicles by id, or a share of cars.

    What is given replaces the scenario's own egos of all three kinds.

    Raises
    ------
    ScenarioError
        If nothing is given, or the share is not in [0, 1].
    """
    if not route and not vehicle and share is None:
        raise ScenarioError("no ego: expected a route, a vehicle id or a share of the passenger cars")
    if share is not None and not 0.0 <= share <= 1.0:
        raise ScenarioError(f"the share of egos is {share:g}; expected at least 0 and at most 1")
    egos = replace(
        scenario.egos,
        routes=(tuple(route),) if route else (),
        vehicles=tuple(vehicle),
        share=share,
        count=max(scenario.egos.count, 1) if route else 0,
    )
    return replace(scenario, egos=egos)
