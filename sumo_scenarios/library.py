"""Scenarios by name, folder or configuration: ``names``, ``load``, ``with_parameters``, ``prepare``."""

from __future__ import annotations

from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import (
    HYBRID_LATERAL_RESOLUTION_M,
    NEVER,
    Egos,
    Scenario,
    egos_of,
    with_egos,
    with_pedestrians,
)
from sumo_scenarios.parameters import (
    check_parameters,
    parameter_choices,
    parameter_names,
    parameter_values,
    with_parameters,
)
from sumo_scenarios.preparation import Prepared, prepare
from sumo_scenarios.schema import defaults, read_table
from sumo_scenarios.suites.build import load_case
from sumo_scenarios.suites.case import is_reference
from sumo_scenarios.sumo_installation import packaged_file
from sumo_scenarios.sumo_options import is_true
from sumo_scenarios.sumocfg import SumoConfiguration, read_sumocfg
from sumo_scenarios.variant import variant

__all__ = [
    "Egos",
    "Prepared",
    "Scenario",
    "ScenarioError",
    "is_built_in",
    "load",
    "names",
    "parameter_choices",
    "parameter_names",
    "parameter_values",
    "prepare",
    "with_egos",
    "with_parameters",
]

LIBRARY = Path(__file__).parent
DEFINITION = "scenario.toml"
# A configuration without an end runs as long as there are vehicles.
DURATION_WITHOUT_END_S = 3600.0


def names() -> tuple[str, ...]:
    """Return the names of the built-in scenarios: every folder here that holds a scenario.toml."""
    return tuple(sorted(path.parent.name for path in LIBRARY.glob(f"*/{DEFINITION}")))


def is_built_in(text: str) -> bool:
    """Return whether a text names a scenario or a suite's case that every installation has."""
    return text in names() or is_reference(text)


def load(name_or_path: str) -> Scenario:
    """Return the scenario of a built-in name, a suite's case, a scenario.toml's folder or a configuration.

    Raises
    ------
    ScenarioError
        If there is no such scenario, or it cannot be read.
    """
    if name_or_path in names():
        return _from_folder(LIBRARY / name_or_path)
    if is_reference(name_or_path):
        return load_case(name_or_path)
    path = Path(name_or_path)
    if path.name == DEFINITION and path.is_file():
        path = path.parent
    if (path / DEFINITION).is_file():
        return _from_folder(path.resolve())
    if path.is_file():
        return _from_sumocfg(path)
    if path.is_dir():
        raise ScenarioError(f"{name_or_path}: the folder has no {DEFINITION}")
    kind = "no such configuration" if path.suffix == ".sumocfg" else "no such scenario"
    raise ScenarioError(
        f"{name_or_path}: {kind}; built-in: {', '.join(names())}; "
        f"or the path of a folder with {DEFINITION} or of a .sumocfg"
    )


def _from_folder(folder: Path, may_have_base: bool = True) -> Scenario:
    table = read_table(folder / DEFINITION)
    if table.base:
        if not may_have_base:
            raise ScenarioError(f"{folder / DEFINITION}: has a base itself; expected a scenario without one")
        return variant(folder, table, _base_of(folder, table.base))
    parameters = defaults(table)
    sumocfg: Path | None = None
    begin_s, step_s, teleport_after_s = 0.0, table.step_s or 0.1, NEVER
    if table.network is None:
        sumocfg = packaged_file(table.packaged_sumocfg) if table.packaged_sumocfg else folder / table.sumocfg
        configuration = _microscopic(sumocfg)
        begin_s = configuration.begin_s
        step_s = table.step_s or configuration.step_s
        teleport_after_s = configuration.teleport_after_s
    hybrid = HYBRID_LATERAL_RESOLUTION_M if table.actuation == "hybrid" else None
    demand = table.demand
    if table.warmup_s >= table.duration_s:
        raise ScenarioError(f"{folder / DEFINITION}: key 'warmup_s': expected less than duration_s")
    scenario = Scenario(
        name=folder.name,
        folder=folder,
        sumocfg=sumocfg,
        description=table.description,
        begin_s=begin_s,
        duration_s=table.duration_s,
        warmup_s=table.warmup_s,
        step_s=step_s,
        actuation=table.actuation,
        lateral_resolution_m=table.lateral_resolution_m or hybrid,
        vehicles_per_hour=demand.vehicles_per_hour if demand else None,
        pedestrians_per_hour=demand.pedestrians_per_hour if demand else None,
        parameters=parameters,
        egos=egos_of(table, parameters),
        teleport_after_s=teleport_after_s,
        table=table,
    )
    try:
        check_parameters(scenario, table)
    except ScenarioError as error:
        raise ScenarioError(f"{folder / DEFINITION}: {error}") from error
    return with_pedestrians(scenario)


def _base_of(folder: Path, base: str) -> Scenario:
    """Return the base of the variant in ``folder``."""
    if base in names():
        return _from_folder(LIBRARY / base, may_have_base=False)
    if is_reference(base):
        return load_case(base)
    path = (folder / base).resolve()
    if not (path / DEFINITION).is_file():
        raise ScenarioError(
            f"{folder / DEFINITION}: base {base!r}: no such scenario; expected one of {', '.join(names())}, "
            f"or a folder with {DEFINITION}, relative to this one"
        )
    return _from_folder(path, may_have_base=False)


def _from_sumocfg(path: Path) -> Scenario:
    configuration = _microscopic(path)
    end_s = configuration.end_s
    duration_s = DURATION_WITHOUT_END_S if end_s is None else end_s - configuration.begin_s
    if duration_s <= 0:
        raise ScenarioError(
            f"{path}: end is {end_s:g} s; expected more than begin, {configuration.begin_s:g} s"
        )
    return Scenario(
        name=path.stem,
        folder=None,
        sumocfg=path.resolve(),
        description=f"SUMO configuration {path.name}",
        begin_s=configuration.begin_s,
        duration_s=duration_s,
        warmup_s=0.0,
        step_s=configuration.step_s,
        actuation="hybrid",
        lateral_resolution_m=configuration.lateral_resolution_m or HYBRID_LATERAL_RESOLUTION_M,
        vehicles_per_hour=None,
        pedestrians_per_hour=None,
        parameters={},
        egos=Egos(),
        teleport_after_s=configuration.teleport_after_s,
    )


def _microscopic(path: Path) -> SumoConfiguration:
    """Return the content of a configuration; a mesoscopic one, without positions on lanes, is refused."""
    configuration = read_sumocfg(path)
    if is_true(configuration.options, "mesosim"):
        raise ScenarioError(f"{path}: mesosim is set; expected a microscopic simulation: remove this option")
    return configuration
