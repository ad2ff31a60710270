"""The subject of a search: scenario, controller, space and criteria, all checked before anything is run."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from analysis.criteria.criterion import Criterion
from analysis.criteria.reading import CriterionError, read_criteria
from analysis.errors import did_you_mean
from analysis.search.axes import Axis
from analysis.search.objective import searchable
from cosim.batches.criteria_file import tables_in
from cosim.errors import InputError
from cosim.inspection.passages import Passage, passages, read_ways
from cosim.running import inventory
from cosim.search.space import OF_PASSAGES, PASSAGE, Parameter, Space, read_space, read_space_file
from sumo_scenarios import library
from sumo_scenarios.distribution import Distribution
from sumo_scenarios.library import Scenario

CROSSINGS = Path(__file__).parent / "crossings.toml"
"""Default space: a pedestrian crosses at any crossing of the network, timed to meet the ego."""


@dataclass(frozen=True, slots=True)
class Subject:
    """The subject of a search."""

    scenario: str
    """The scenario as the user named it."""
    place: str
    """Name of a built-in scenario, or an absolute path."""
    loaded: Scenario
    controller: str
    values: Mapping[str, str]
    """Scenario parameters that are set for all trials."""
    controller_settings: tuple[tuple[str, str], ...]
    space: Space
    criteria: tuple[Criterion, ...]
    criteria_tables: tuple[Mapping[str, Any], ...]
    """Criteria that replace the scenario's own, as tables of TOML; if empty, the scenario's own apply."""
    passages: Mapping[str, Passage] = field(default_factory=dict)
    """Passages by name."""
    notes: tuple[str, ...] = ()

    @property
    def configured(self) -> bool:
        """Whether the subject is a SUMO configuration rather than a scenario."""
        return self.loaded.table is None


def read_subject(
    scenario: str,
    controller: str,
    settings: Mapping[str, str],
    space_file: Path | None = None,
    criteria_file: Path | None = None,
) -> Subject:
    """Return the subject of a search.

    Raises
    ------
    InputError
        If a scenario, controller, parameter, space or criterion is invalid; the message is one line.
    """
    try:
        loaded = library.load(scenario)
    except (library.ScenarioError, OSError) as error:
        raise InputError(str(error)) from error
    if loaded.variant is not None:
        raise InputError(f"{scenario}: has a base itself; expected the base, or a scenario without one")
    space = _space(loaded, space_file)
    tables = _criteria_tables(loaded, space, criteria_file)
    own = _own_tables(loaded)
    if not tables and any("scenarios" in one for one in own):
        tables = own  # trials are scenarios of other names
    criteria = _criteria(tables or own, scenario, loaded.name, controller)
    tables = _of_any_name(tables, loaded.name)
    values, of_controller = _split(loaded, controller, settings)
    place = scenario if library.is_built_in(scenario) else str(Path(scenario).resolve())
    subject = Subject(
        scenario, place, loaded, controller, values, of_controller, space, criteria, tuple(tables)
    )
    if space.table.where is not None:
        subject = _with_passages(subject)
    _check_names(subject)
    return subject


def _space(loaded: Scenario, file: Path | None) -> Space:
    if file is not None:
        return read_space_file(file)
    if loaded.table is not None and loaded.table.search:
        return read_space(loaded.table.search, f"{loaded.name}: [search]", loaded.folder)
    return read_space(tomllib.loads(CROSSINGS.read_text("utf-8")), CROSSINGS.name)


def _own_tables(loaded: Scenario) -> list[dict[str, Any]]:
    return [] if loaded.table is None else loaded.table.criteria


def _criteria_tables(loaded: Scenario, space: Space, file: Path | None) -> list[dict[str, Any]]:
    """Return the criteria that replace the scenario's own; empty if the scenario's own apply."""
    if file is None:
        if space.table.criteria and not _own_tables(loaded):
            return space.table.criteria
        return []
    return tables_in(file)


def _of_any_name(tables: Sequence[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    """Return the criteria that apply to a scenario, so that they apply to it under any name."""
    return [
        {key: value for key, value in one.items() if key != "scenarios"}
        for one in tables
        if not one.get("scenarios") or name in one["scenarios"]
    ]


def _criteria(
    tables: list[dict[str, Any]], scenario: str, name: str, controller: str
) -> tuple[Criterion, ...]:
    try:
        criteria = read_criteria(tables)
    except CriterionError as error:
        raise InputError(f"{scenario}: {error}") from error
    found = searchable([one for one in criteria if one.applies_to(name, controller)])
    if not found:
        raise InputError(
            f"{scenario}: no criterion that one run can violate; expected [[criteria]] of scope run or "
            "encounter in the scenario.toml, in the file after --space or in one after --criteria"
        )
    return found


def _split(
    loaded: Scenario, controller: str, settings: Mapping[str, str]
) -> tuple[dict[str, str], tuple[tuple[str, str], ...]]:
    """Return the settings of the scenario and those of the controller."""
    try:
        of_controller = inventory.controller_parameters(controller)
    except ValueError as error:
        raise InputError(str(error)) from error
    names = library.parameter_names(loaded)
    for key in settings:
        if key not in names and key not in of_controller:
            hint = did_you_mean(key, [*names, *of_controller])
            raise InputError(
                f"--set {key}: no such parameter; {hint}scenario {loaded.name!r} has {', '.join(names)}; "
                f"controller {controller!r} has {', '.join(of_controller) or 'none'}"
            )
    return (
        {key: text for key, text in settings.items() if key in names},
        tuple((key, text) for key, text in settings.items() if key not in names),
    )


def _with_passages(subject: Subject) -> Subject:
    """Add the axis that says where a trial takes place."""
    where = subject.space.table.where
    assert where is not None
    with TemporaryDirectory(prefix="cosim-") as work:
        try:
            net_file = library.prepare(subject.loaded, 1, Path(work)).net_file
        except (library.ScenarioError, OSError) as error:
            raise InputError(str(error)) from error
    ways = read_ways(net_file)
    known = ways.network.crossings
    for name in where.crossings:
        if name not in known:
            hint = did_you_mean(name, sorted(known))
            raise InputError(
                f"{subject.space.place}: where.crossings: {subject.loaded.name} has no crossing {name!r}; "
                f"{hint}it has {', '.join(sorted(known)[:20]) or 'none'}"
            )
    found = passages(ways, where.crossings, where.shortest_approach_m, where.longest_approach_m)
    if not found:
        raise InputError(
            f"{subject.scenario}: no crossing that a car can drive over after an approach of "
            f"{where.shortest_approach_m:g} to {where.longest_approach_m:g} m; see cosim inspect"
        )
    left = len(known) - len({one.crossing for one in found})
    notes = (f"{len(found)} passages over {len(known) - left} of {len(known)} crossings are searched",)
    choices = tuple(one.name for one in found)
    axis = Axis(PASSAGE, choices=choices)
    likely = Distribution("choice", tuple(float(i) for i in range(len(choices))))
    where_axis = Parameter(axis, likely, "Crossing, manoeuvre and approach", "the network")
    others = subject.space.parameters
    if len(choices) > 1:
        others = (where_axis, *others)
    return replace(
        subject,
        space=replace(subject.space, parameters=others),
        passages={one.name: one for one in found},
        notes=notes,
    )


def _check_names(subject: Subject) -> None:
    """Refuse parameters that change nothing, and names that no parameter has."""
    named = subject.space.named
    own = {one.axis.name for one in subject.space.parameters}
    given = own | (set(OF_PASSAGES) if subject.passages else set())
    place = subject.space.place
    for name in sorted(named - given):
        hint = did_you_mean(name, sorted(given))
        raise InputError(f"{place}: names ${name}; {hint}parameters that exist: {', '.join(sorted(given))}")
    of_scenario = library.parameter_names(subject.loaded)
    for name in sorted(own - named - {PASSAGE}):
        if name not in of_scenario or subject.configured:
            raise InputError(
                f"{place}: parameters.{name} changes nothing; expected ${name} somewhere in the table, or a "
                f"parameter of {subject.loaded.name}: {', '.join(of_scenario)}"
            )
