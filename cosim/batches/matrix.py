"""Builds the runs of a study: scenarios × controllers × sensing × seeds × varied parameters."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import did_you_mean
from cosim.batches.job import Configuration, Job
from cosim.batches.study import StudyTable, Value, parse_seeds
from cosim.errors import InputError
from cosim.running import inventory
from cosim.sensing import catalog as sensing_catalog
from cosim.sensing.chosen import PREFIX, name_in
from sumo_scenarios import library

EGO_KEYS = ("ego_route", "ego_vehicle", "ego_share")
"""Keys that select the egos; like the flags of ``cosim run``, they override every scenario."""


@dataclass(frozen=True, slots=True)
class Matrix:
    """Every run of a study."""

    configurations: tuple[Configuration, ...]
    seeds: tuple[int, ...]

    def jobs(self) -> list[Job]:
        """Return the runs, seeds varying slowest, so that a study stopped early still has paired runs."""
        return [Job(one, seed) for seed in self.seeds for one in self.configurations]


@dataclass(frozen=True, slots=True)
class _Place:
    text: str
    place: str
    name: str
    parameters: tuple[str, ...]
    sensing: str
    """Name of the scenario's own sensing model."""


def build_matrix(study: StudyTable, file: Path) -> Matrix:
    """Return the runs of a study.

    A parameter of ``[set]`` or ``[vary]`` applies to the scenarios that have it, otherwise to the
    controllers or sensing models that have it, as with ``cosim run --set``. In a configuration in which
    none has it, it is left out and does not multiply the runs.

    Raises
    ------
    InputError
        If a scenario, controller or parameter does not exist.
    """
    try:
        places = [_place(text, study, file.parent) for text in study.scenarios]
        parameters = {name: inventory.controller_parameters(name) for name in study.controllers}
        _check_names(places)
        sensing = {name: _sensing_parameters(name) for place in places for name in _models(study, place)}
        moved = inventory.moved_parameters(study.controllers)
        _check_keys([*study.settings, *study.vary], places, {**parameters, **sensing}, moved)
        configurations = [
            one
            for place in places
            for controller in study.controllers
            for model in _models(study, place)
            for one in _configurations(study, place, controller, parameters[controller], model)
        ]
    except (ValueError, InputError) as error:
        raise InputError(f"{file}: {error}") from error
    return Matrix(tuple(configurations), parse_seeds(study.seeds))


def _place(text: str, study: StudyTable, folder: Path) -> _Place:
    place = text if library.is_built_in(text) else str((folder / text).resolve())
    if not library.is_built_in(text) and not Path(place).exists():
        place = text  # so that the error message names the scenario as the user wrote it
    scenario = library.load(place)
    values = {**study.settings, **{key: some[0] for key, some in study.vary.items()}}
    # The choice of egos decides which parameters the scenario has.
    chosen = _egos(values)
    if chosen:
        scenario = library.with_egos(
            scenario,
            route=chosen.get("ego_route", ()),
            vehicle=(chosen["ego_vehicle"],) if "ego_vehicle" in chosen else (),
            share=chosen.get("ego_share"),
        )
    table = scenario.table.sensing if scenario.table is not None else {}
    return _Place(text, place, scenario.name, library.parameter_names(scenario), name_in(table))


def _models(study: StudyTable, place: _Place) -> Sequence[str]:
    return study.sensing or (place.sensing,)


def _sensing_parameters(model: str) -> tuple[str, ...]:
    names = tuple(sensing_catalog.parameters(model))
    return (*names, *(f"{PREFIX}{name}" for name in names))


def _check_names(places: Iterable[_Place]) -> None:
    seen: dict[str, str] = {}
    for place in places:
        if place.name in seen:
            raise InputError(
                f"the scenarios {seen[place.name]} and {place.text} are both called {place.name}; "
                "their rows could not be told apart: expected different names"
            )
        seen[place.name] = place.text


def _check_keys(
    keys: Iterable[str],
    places: Sequence[_Place],
    controllers: Mapping[str, tuple[str, ...]],
    moved: Mapping[str, str],
) -> None:
    known = {*EGO_KEYS, *itertools.chain(*(place.parameters for place in places), *controllers.values())}
    for key in keys:
        if key in known:
            continue
        if key in moved:
            raise InputError(f"{key}: no such parameter any more: {moved[key]}")
        hint = did_you_mean(key, sorted(known))
        of_scenarios = itertools.chain(*(place.parameters for place in places), EGO_KEYS)
        exist = [f"the study's scenarios have {', '.join(dict.fromkeys(of_scenarios))}"]
        exist += [f"{name} has {', '.join(names) or 'none'}" for name, names in controllers.items()]
        raise InputError(f"{key}: no such parameter; {hint}{'; '.join(exist)}")


def _configurations(
    study: StudyTable, place: _Place, controller: str, parameters: Sequence[str], model: str
) -> list[Configuration]:
    of_road = {*place.parameters, *_sensing_parameters(model)}
    known = {*EGO_KEYS, *of_road, *parameters}
    differs = (("sensing", model),) if len(study.sensing) > 1 else ()
    fixed = {key: value for key, value in study.settings.items() if key in known}
    axes = {key: values for key, values in study.vary.items() if key in known}
    found = []
    for values in itertools.product(*axes.values()):
        varied = dict(zip(axes, values, strict=True))
        everything = {**fixed, **varied}
        settings = [(key, _text(value)) for key, value in everything.items() if key not in EGO_KEYS]
        one = Configuration(
            scenario=place.text,
            place=place.place,
            scenario_name=place.name,
            controller=controller,
            scenario_settings=tuple(pair for pair in settings if pair[0] in of_road),
            controller_settings=tuple(pair for pair in settings if pair[0] not in of_road),
            varied=(*differs, *((key, _text(value)) for key, value in varied.items())),
            sensing=model if study.sensing else None,
            record=study.record,
            **_egos(everything),
        )
        one.request(0)  # refuses selections of egos that exclude each other, and impossible recordings
        found.append(one)
    return found


def _egos(values: Mapping[str, Value]) -> dict[str, Any]:
    """Return the selection of egos in the form of a run's request."""
    chosen: dict[str, Any] = {}
    if "ego_route" in values:
        chosen["ego_route"] = tuple(_text(values["ego_route"]).split())
    if "ego_vehicle" in values:
        chosen["ego_vehicle"] = _text(values["ego_vehicle"])
    if "ego_share" in values:
        share = values["ego_share"]
        if isinstance(share, bool | str):
            raise InputError(f"ego_share: expected a number above 0 and at most 1, got {share!r}")
        chosen["ego_share"] = float(share)
    return chosen


def _text(value: Value) -> str:
    """Return a value of TOML in the form that ``--set`` takes."""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else str(value)
