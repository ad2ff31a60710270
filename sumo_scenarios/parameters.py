"""Applies ``--set key=value`` texts to a scenario, by key and type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, get_args

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import HYBRID_LATERAL_RESOLUTION_M, Scenario, routes_of, with_pedestrians
from sumo_scenarios.schema import (
    Actuation,
    AtLeastOne,
    NotNegative,
    ParameterValue,
    Positive,
    ScenarioTable,
    Share,
    Step,
)
from sumo_scenarios.texts import Text, kind_of, read

SCENARIO_KEYS: Mapping[str, Any] = {
    "duration_s": Positive,
    "warmup_s": NotNegative,
    "step_s": Step,
    "actuation": Actuation,
    "lateral_resolution_m": Positive,
}
"""Keys that every scenario has, which are fields of ``Scenario``, and their types."""
DEMAND_KEYS: Mapping[str, Any] = {"vehicles_per_hour": NotNegative, "pedestrians_per_hour": NotNegative}
"""Keys of scenarios whose demand is ours, and their types."""
EGO_KEYS: Mapping[str, tuple[str, Any]] = {
    "ego_count": ("count", AtLeastOne),
    "ego_first_depart_s": ("first_depart_s", NotNegative),
    "ego_headway_s": ("headway_s", Positive),
    "ego_vehicle_type": ("vehicle_type", Text),
    "ego_depart_lane": ("depart_lane", Text),
    "ego_depart_speed_mps": ("depart_speed", Text),
}
"""Keys of scenarios with inserted egos: field of ``Egos``, and its type."""


def parameter_names(scenario: Scenario) -> tuple[str, ...]:
    """Return the keys that ``with_parameters`` applies to this scenario."""
    demand = tuple(key for key in DEMAND_KEYS if getattr(scenario, key) is not None)
    share = () if scenario.egos.share is None else ("ego_share",)
    inserted = tuple(EGO_KEYS) if scenario.egos.routes else ()
    return (*SCENARIO_KEYS, *demand, *inserted, *share, *scenario.parameters)


def check_parameters(scenario: Scenario, table: ScenarioTable) -> None:
    """Check that no parameter has the name of something else that runs or demand files know.

    Raises
    ------
    ScenarioError
        If one has; one of the two could not be set.
    """
    demand = {key for key in DEMAND_KEYS if getattr(scenario, key) is not None}
    taken = {*SCENARIO_KEYS, *EGO_KEYS, *demand, "ego_share", "end_s", *table.rates, *table.times}
    for name in sorted(taken & scenario.parameters.keys()):
        raise ScenarioError(
            f"key 'parameters.{name}': the name is taken; expected none of {', '.join(sorted(taken))}"
        )


def parameter_values(scenario: Scenario) -> dict[str, ParameterValue | None]:
    """Return the present value of each of ``parameter_names``."""
    egos = {key: getattr(scenario.egos, field) for key, (field, _) in EGO_KEYS.items()}
    egos["ego_share"] = scenario.egos.share
    return {
        key: scenario.parameters[key]
        if key in scenario.parameters
        else egos[key]
        if key in egos
        else getattr(scenario, key)
        for key in parameter_names(scenario)
    }


def parameter_choices(scenario: Scenario, key: str) -> tuple[str, ...]:
    """Return the only texts that a parameter accepts; empty if it accepts any value of its type."""
    if key == "actuation":
        return get_args(Actuation)
    declared = scenario.table.parameters.get(key) if scenario.table is not None else None
    return tuple(declared.choices) if declared is not None else ()


def with_parameters(scenario: Scenario, texts: Mapping[str, str]) -> tuple[Scenario, dict[str, str]]:
    """Return the scenario with these values, and the texts whose keys it does not have.

    Raises
    ------
    ScenarioError
        If a value has the wrong type or range, or the warm-up leaves no time for a run.
    """
    names = parameter_names(scenario)
    fields: dict[str, Any] = {}
    ego_fields: dict[str, Any] = {}
    further: dict[str, ParameterValue] = dict(scenario.parameters)
    leftover = {key: text for key, text in texts.items() if key not in names}
    for key, text in texts.items():
        if key in leftover:
            continue
        if key in scenario.parameters:
            further[key] = _further(scenario, key, text)
        elif key in EGO_KEYS:
            field, kind = EGO_KEYS[key]
            ego_fields[field] = read(kind, key, text)
        elif key == "ego_share":
            ego_fields["share"] = read(Share, key, text)
        else:
            fields[key] = read(SCENARIO_KEYS.get(key) or DEMAND_KEYS[key], key, text)
    if scenario.table is not None and _routes_depend_on(scenario, texts):
        ego_fields["routes"] = routes_of(scenario.table, further)
    if "actuation" in fields and "lateral_resolution_m" not in fields:
        fields["lateral_resolution_m"] = lateral_resolution(scenario, fields["actuation"])
    changed = replace(scenario, parameters=further, egos=replace(scenario.egos, **ego_fields), **fields)
    if changed.warmup_s >= changed.duration_s:
        raise ScenarioError(
            f"warmup_s={changed.warmup_s:g}: expected less than duration_s={changed.duration_s:g}, "
            "which includes the warm-up"
        )
    return with_pedestrians(changed), leftover


def lateral_resolution(scenario: Scenario, actuation: Actuation) -> float | None:
    """Return the lateral resolution of a scenario whose egos are actuated in this way [m].

    With the sublane model, SUMO sees an ego between two lanes; actuation ``move`` does not need it.
    """
    if actuation == "move":
        return None
    return scenario.lateral_resolution_m or HYBRID_LATERAL_RESOLUTION_M


def _routes_depend_on(scenario: Scenario, texts: Mapping[str, str]) -> bool:
    assert scenario.table is not None
    return any(key in texts for route in scenario.table.egos.routes for key in route.when)


def _further(scenario: Scenario, key: str, text: str) -> ParameterValue:
    assert scenario.table is not None, "only a scenario.toml declares further parameters"
    parameter = scenario.table.parameters[key]
    value: ParameterValue = read(kind_of(parameter), key, text)
    return value == "true" if isinstance(parameter.default, bool) else value
