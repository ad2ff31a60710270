"""``--set key=value`` texts, applied to a scenario by key and type."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, get_args

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import HYBRID_LATERAL_RESOLUTION_M, Scenario, routes_of, with_pedestrians
from sumo_scenarios.schema import LONGEST_STEP_S, SHORTEST_STEP_S, Actuation, ParameterTable, ParameterValue

Reader = Callable[[str, str], Any]


def _number(minimum: float, maximum: float = math.inf, open_below: bool = False) -> Reader:
    def read(key: str, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            raise ScenarioError(f"{key}={text}: expected a number") from None
        too_low = value <= minimum if open_below else value < minimum
        if not math.isfinite(value) or too_low or value > maximum:
            raise ScenarioError(f"{key}={text}: expected {_range(minimum, maximum, open_below)}")
        return value

    return read


def _range(minimum: float, maximum: float, open_below: bool) -> str:
    below = f"more than {minimum:g}" if open_below else f"at least {minimum:g}"
    if not math.isfinite(minimum):
        below = "a finite number"
    return below if math.isinf(maximum) else f"{below} and at most {maximum:g}"


def _count(key: str, text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        raise ScenarioError(f"{key}={text}: expected a whole number") from None
    if value < 1:
        raise ScenarioError(f"{key}={text}: expected at least 1")
    return value


def _choice(*choices: str) -> Reader:
    def read(key: str, text: str) -> str:
        if text not in choices:
            raise ScenarioError(f"{key}={text}: expected one of {', '.join(choices)}")
        return text

    return read


def _text(key: str, text: str) -> str:
    if not text.strip():
        raise ScenarioError(f"{key}=: expected a value")
    return text


# Keys of every scenario: name of the field of Scenario, and how its text is read.
SCENARIO_KEYS: Mapping[str, Reader] = {
    "duration_s": _number(0.0, open_below=True),
    "warmup_s": _number(0.0),
    "step_s": _number(SHORTEST_STEP_S, LONGEST_STEP_S),
    "actuation": _choice(*get_args(Actuation)),
    "lateral_resolution_m": _number(0.0, open_below=True),
}
# Only where the demand is ours.
DEMAND_KEYS: Mapping[str, Reader] = {
    "vehicles_per_hour": _number(0.0),
    "pedestrians_per_hour": _number(0.0),
}
# Key, field of Egos, and how its text is read.
EGO_KEYS: Mapping[str, tuple[str, Reader]] = {
    "ego_count": ("count", _count),
    "ego_first_depart_s": ("first_depart_s", _number(0.0)),
    "ego_headway_s": ("headway_s", _number(0.0, open_below=True)),
    "ego_vehicle_type": ("vehicle_type", _text),
    "ego_depart_lane": ("depart_lane", _text),
    "ego_depart_speed_mps": ("depart_speed", _text),
}


def parameter_names(scenario: Scenario) -> tuple[str, ...]:
    """Return the keys that ``with_parameters`` applies to this scenario."""
    demand = tuple(key for key in DEMAND_KEYS if getattr(scenario, key) is not None)
    share = () if scenario.egos.share is None else ("ego_share",)
    inserted = tuple(EGO_KEYS) if scenario.egos.routes else ()
    return (*SCENARIO_KEYS, *demand, *inserted, *share, *scenario.parameters)


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
    """Return the only texts that a parameter takes; empty where it takes any of its type."""
    if key == "actuation":
        return get_args(Actuation)
    declared = scenario.table.parameters.get(key) if scenario.table is not None else None
    return tuple(declared.choices) if declared is not None else ()


def with_parameters(scenario: Scenario, texts: Mapping[str, str]) -> tuple[Scenario, dict[str, str]]:
    """Return the scenario with these values, and the keys that are not the scenario's.

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
            field, read = EGO_KEYS[key]
            ego_fields[field] = read(key, text)
        elif key == "ego_share":
            ego_fields["share"] = _number(0.0, 1.0, open_below=True)(key, text)
        else:
            fields[key] = (SCENARIO_KEYS.get(key) or DEMAND_KEYS[key])(key, text)
    if scenario.table is not None and _routes_depend_on(scenario, texts):
        ego_fields["routes"] = routes_of(scenario.table, further)
    if "actuation" in fields and "lateral_resolution_m" not in fields:
        fields["lateral_resolution_m"] = _lateral_resolution(scenario, fields["actuation"])
    changed = replace(scenario, parameters=further, egos=replace(scenario.egos, **ego_fields), **fields)
    if changed.warmup_s >= changed.duration_s:
        raise ScenarioError(
            f"warmup_s={changed.warmup_s:g}: expected less than duration_s={changed.duration_s:g}, "
            "which includes the warm-up"
        )
    return with_pedestrians(changed), leftover


def _lateral_resolution(scenario: Scenario, actuation: str) -> float | None:
    # The sublane model is what lets SUMO see an ego between two lanes; moving alone does not need it.
    if actuation == "move":
        return None
    return scenario.lateral_resolution_m or HYBRID_LATERAL_RESOLUTION_M


def _routes_depend_on(scenario: Scenario, texts: Mapping[str, str]) -> bool:
    assert scenario.table is not None
    return any(key in texts for route in scenario.table.egos.routes for key in route.when)


def _further(scenario: Scenario, key: str, text: str) -> ParameterValue:
    assert scenario.table is not None, "only a scenario.toml declares further parameters"
    parameter: ParameterTable = scenario.table.parameters[key]
    default = parameter.default
    if parameter.choices:
        return str(_choice(*parameter.choices)(key, text))
    if isinstance(default, bool):
        return bool(_choice("true", "false")(key, text) == "true")
    if isinstance(default, str):
        return _text(key, text)
    minimum = -math.inf if parameter.minimum is None else parameter.minimum
    value: float = _number(minimum, math.inf if parameter.maximum is None else parameter.maximum)(key, text)
    if isinstance(default, int):
        if value != int(value):
            raise ScenarioError(f"{key}={text}: expected a whole number")
        return int(value)
    return value
