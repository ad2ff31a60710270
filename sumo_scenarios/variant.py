"""Variants: scenarios on the roads and with the demand of a base, whose values fill keys left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import Scenario, egos_of
from sumo_scenarios.parameters import lateral_resolution, parameter_names, with_parameters
from sumo_scenarios.schema import ParameterValue, ScenarioTable

_OF_RUNS = ("duration_s", "warmup_s", "step_s", "actuation", "lateral_resolution_m")
_OF_THE_TABLE = ("description", "egos", "sensing", "pedestrians", "criteria", "types")


def variant(folder: Path, table: ScenarioTable, base: Scenario) -> Scenario:
    """Return the scenario that a ``scenario.toml`` with a base describes.

    Parameters
    ----------
    folder
        Folder of the variant; its name is the scenario's.
    table
        Content of the variant's file.
    base
        Scenario whose files are used.

    Raises
    ------
    ScenarioError
        If the base is a SUMO configuration, or does not accept a value or types.
    """
    place = folder / "scenario.toml"
    if base.table is None:
        raise ScenarioError(
            f"{place}: base: expected a scenario, got a SUMO configuration; use the key sumocfg"
        )
    if table.types and base.sumocfg is None:
        raise ScenarioError(
            f"{place}: 'types' belongs to a configuration; the types of {base.name} are in its [demand]"
        )
    said = {key: getattr(table, key) for key in _OF_THE_TABLE if key in table.model_fields_set}
    merged = base.table.model_copy(update=said)
    try:
        merged.egos.check_conditions(base.parameters)
    except ValueError as error:
        raise ScenarioError(f"{place}: {error}") from error
    runs = {key: getattr(table, key) for key in _OF_RUNS if key in table.model_fields_set}
    if "actuation" in runs and "lateral_resolution_m" not in runs:
        runs["lateral_resolution_m"] = lateral_resolution(base, table.actuation)
    changed = replace(
        base,
        name=folder.name,
        description=table.description,
        table=merged,
        egos=egos_of(merged, base.parameters),
        variant=folder,
        pedestrians_in=folder if "pedestrians" in said else None,
        **runs,
    )
    try:
        found, unknown = with_parameters(changed, {key: as_text(one) for key, one in table.values.items()})
    except ScenarioError as error:
        raise ScenarioError(f"{place}: {str(error).removeprefix(f'{place}: ')}") from error
    if unknown:
        raise ScenarioError(
            f"{place}: values.{min(unknown)}: {base.name} has no such parameter; "
            f"it has {', '.join(parameter_names(changed))}"
        )
    return found


def as_text(value: ParameterValue) -> str:
    """Return a TOML value as a text for ``--set``.

    Examples
    --------
    >>> as_text(True), as_text(0.1), as_text("bus")
    ('true', '0.1', 'bus')
    """
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else str(value)
