"""Model of a scenario: frozen values from which a run is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.pedestrian_tables import PedestrianTable, read_pedestrians
from sumo_scenarios.schema import Actuation, ParameterValue, ScenarioTable

HYBRID_LATERAL_RESOLUTION_M = 0.4
NEVER = -1.0
"""Value of SUMO's ``time-to-teleport`` with which vehicles are never teleported."""


@dataclass(frozen=True, slots=True)
class Egos:
    """Which vehicles are egos: inserted trips, vehicles taken over by id, or a share of passenger cars."""

    routes: tuple[tuple[str, ...], ...] = ()
    """Edge ids, one ego trip each, taken in turn until there are ``count`` egos."""
    vehicles: tuple[str, ...] = ()
    """Ids of vehicles of the demand to take over."""
    share: float | None = None
    """Share of the demand's passenger cars to take over, in [0, 1]; the seed decides which ones."""
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
    """A road network, its demand and its egos."""

    name: str
    folder: Path | None
    """Folder of scenario.toml; ``None`` for a user's SUMO configuration."""
    sumocfg: Path | None
    """SUMO configuration to run; ``None`` if the network is built from plain sources."""
    description: str
    begin_s: float
    """Simulated time of the first step [s]; 54000 is 15:00."""
    duration_s: float
    """Simulated time from the first step to the end, warm-up included [s]."""
    warmup_s: float
    """Time after which egos appear and recording starts [s]."""
    step_s: float
    actuation: Actuation
    lateral_resolution_m: float | None
    """Resolution of SUMO's sublane model; ``None`` keeps the configuration's lane-change model [m]."""
    vehicles_per_hour: float | None
    """Rate of vehicles, as the scenario's README defines it; ``None`` for a demand that is not ours [1/h]."""
    pedestrians_per_hour: float | None
    parameters: Mapping[str, ParameterValue]
    """Further parameters of this scenario."""
    egos: Egos
    teleport_after_s: float = NEVER
    """Time after which SUMO teleports a standing vehicle; never, if not positive [s]."""
    table: ScenarioTable | None = None
    """Content of scenario.toml."""
    pedestrians: tuple[PedestrianTable, ...] = ()
    """Scripted pedestrians, who are not part of SUMO's demand."""
    variant: Path | None = None
    """Folder of a variant's scenario.toml; ``folder`` is then the folder of its base."""
    pedestrians_in: Path | None = None
    """Folder of the scenario.toml with the scripted pedestrians; ``None`` means ``folder``."""


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
    """Return the ego trips whose ``when`` matches these parameters."""
    return tuple(
        tuple(route.edges.split())
        for route in table.egos.routes
        if all(parameters[key] == value for key, value in route.when.items())
    )


def with_pedestrians(scenario: Scenario) -> Scenario:
    """Return the scenario with its scripted pedestrians for its present parameters.

    Raises
    ------
    ScenarioError
        If a table is wrong; the message is one line with file, row and key.
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

    The given egos replace the scenario's own egos of all three kinds.

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
