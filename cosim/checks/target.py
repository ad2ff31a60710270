"""Targets of a check: turns a scenario, a study or a suite into a study with the criteria of its runs."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.criteria.criterion import Criterion
from analysis.criteria.reading import CriterionError, read_criteria
from analysis.wording import some
from cosim.batches.criteria_file import tables_in
from cosim.batches.job import Configuration
from cosim.batches.matrix import Matrix, build_matrix
from cosim.batches.study import DEFAULT_TIMEOUT_S, StudyTable, read_study, study_of
from cosim.errors import InputError
from cosim.running import inventory
from sumo_scenarios import library

if TYPE_CHECKING:
    from cosim.suites.judging import Case

SUITE = "suite:"
DEFAULT_CONTROLLER = "vo_mpc"
DEFAULT_SEEDS = "1"
_UNSAFE = re.compile(r"[^A-Za-z0-9_.+=-]+")


@dataclass(frozen=True, slots=True)
class Wishes:
    """Options of the command line for every target."""

    controllers: tuple[str, ...] = ()
    """If empty, those of the study or, without one, the default controller."""
    seeds: str | None = None
    settings: Mapping[str, str] = field(default_factory=dict)
    criteria: Path | None = None
    """A file whose criteria replace those of the target."""
    part: str | None = None
    """Selects the scenarios or cases of a target whose names contain this text or match this pattern."""
    run_timeout_s: float | None = None

    def narrows(self) -> bool:
        """Return whether the options may leave a criterion without a run to judge."""
        return bool(self.controllers or self.part)


@dataclass(frozen=True, slots=True)
class Target:
    """Something to check."""

    name: str
    """Name of its folder and of its test suite."""
    study: Path
    """The study file, or a name to use in its place in messages."""
    table: StudyTable
    changed: bool
    """Whether the table differs from that of a file."""
    matrix: Matrix
    criteria: Mapping[Configuration, tuple[Criterion, ...]]
    cases: Mapping[str, Case]
    """Cases of a suite, by the reference of the scenario."""


def expanded(text: str) -> tuple[str, ...]:
    """Return the study files in a folder, such as that of a search; return any other target unchanged.

    Parameters
    ----------
    text
        A target of the command line.
    """
    path = Path(text)
    if text.startswith(SUITE) or not path.is_dir() or (path / library.DEFINITION).is_file():
        return (text,)
    return tuple(str(file) for file in sorted(path.glob("*.toml"))) or (text,)


def read_target(text: str, wishes: Wishes) -> Target:
    """Return the runs of a target and the criteria that judge them.

    Raises
    ------
    InputError
        If the target does not exist, a criterion is wrong or judges no run, or nothing matches ``part``.
    """
    if text.startswith(SUITE):
        return _suite(text, wishes)
    path = Path(text)
    if path.suffix == ".toml" and path.name != library.DEFINITION:
        return _study(path, wishes)
    return _scenario(text, wishes)


def _scenario(text: str, wishes: Wishes) -> Target:
    try:
        name = library.load(text).name
    except ValueError as error:
        raise InputError(
            f"{error}; or a study file (.toml), or {SUITE}NAME" if not Path(text).exists() else str(error)
        ) from error
    table = _table(_part([text], wishes, name), name, wishes)
    return _with_criteria(name, Path(name), table, True, wishes, own=None)


def _study(path: Path, wishes: Wishes) -> Target:
    # Controllers of the command line replace those of the file.
    said = read_study(path, allow_programs=bool(wishes.controllers))
    own = _read(said.criteria, str(path)) if said.criteria and wishes.criteria is None else None
    scenarios = _part(said.scenarios, wishes, str(path))
    changes: dict[str, Any] = {}
    if scenarios != said.scenarios:
        changes["scenarios"] = scenarios
    if wishes.controllers:
        changes["controllers"] = list(wishes.controllers)
    if wishes.seeds is not None:
        changes["seeds"] = wishes.seeds
    if wishes.settings:
        changes["set"] = {**said.settings, **_values(wishes.settings)}
    if wishes.run_timeout_s is not None:
        changes["run_timeout_s"] = wishes.run_timeout_s
    content = {**said.model_dump(by_alias=True, exclude_unset=True), **changes}
    table = study_of(content, str(path))
    return _with_criteria(path.stem, path, table, bool(changes), wishes, own)


def _suite(text: str, wishes: Wishes) -> Target:
    from cosim.suites import judging  # loaded only if a suite is asked for

    every = {one.name: one for one in judging.cases(text)}
    cases = {every[name].reference: every[name] for name in _part(list(every), wishes, text)}
    label = _UNSAFE.sub("-", f"suite-{text.removeprefix(SUITE).partition('/')[0]}")
    table = _table(list(cases), label, wishes)
    return _with_criteria(label, Path(label), table, True, wishes, own=(), cases=cases)


def _table(scenarios: Sequence[str], name: str, wishes: Wishes) -> StudyTable:
    content = {
        "scenarios": list(scenarios),
        "controllers": list(wishes.controllers or (DEFAULT_CONTROLLER,)),
        "seeds": DEFAULT_SEEDS if wishes.seeds is None else wishes.seeds,
        "run_timeout_s": DEFAULT_TIMEOUT_S if wishes.run_timeout_s is None else wishes.run_timeout_s,
        "set": _values(wishes.settings),
    }
    return study_of(content, name)


def _values(settings: Mapping[str, str]) -> dict[str, Any]:
    """Return settings in the form of a study file: as texts, except for the share, which is a number."""
    found: dict[str, Any] = dict(settings)
    if "ego_share" in found:
        try:
            found["ego_share"] = float(found["ego_share"])
        except ValueError:
            raise InputError(f"--set ego_share={found['ego_share']}: expected a number") from None
    return found


def _part(names: list[str], wishes: Wishes, where: str) -> list[str]:
    wanted = wishes.part
    if wanted is None:
        return names
    found = [name for name in names if wanted in name or fnmatch.fnmatchcase(name, wanted)]
    if not found:
        raise InputError(f"--filter {wanted}: nothing in {where} matches; there are {some(names, 12)}")
    return found


def _with_criteria(
    name: str,
    study: Path,
    table: StudyTable,
    changed: bool,
    wishes: Wishes,
    own: tuple[Criterion, ...] | None,
    cases: Mapping[str, Case] | None = None,
) -> Target:
    """Return the target with its criteria; if ``own`` is ``None``, each scenario brings its own."""
    matrix = build_matrix(table, study)
    whole = own
    if wishes.criteria is not None:
        whole = _read(tables_in(wishes.criteria), str(wishes.criteria))
    if whole is not None:
        _check_names(whole, matrix, wishes, str(wishes.criteria or study))
        found = {one: _applying(whole, one) for one in matrix.configurations}
    else:
        found = {
            one: _applying(criteria_of_scenario(one.place, one.scenario_name), one)
            for one in matrix.configurations
        }
    return Target(_UNSAFE.sub("-", name), study, table, changed, matrix, found, cases or {})


def _applying(criteria: Sequence[Criterion], one: Configuration) -> tuple[Criterion, ...]:
    return tuple(each for each in criteria if each.applies_to(one.scenario_name, one.controller))


def criteria_of_scenario(reference: str, name: str) -> tuple[Criterion, ...]:
    """Return the criteria of a scenario; none for a SUMO configuration."""
    table = library.load(reference).table
    return criteria_of_tables(table.criteria, name) if table is not None and table.criteria else ()


def criteria_of_tables(tables: Sequence[Mapping[str, Any]], where: str) -> tuple[Criterion, ...]:
    """Return the criteria that tables describe.

    Raises
    ------
    InputError
        If a criterion is wrong; the message begins with ``where``.
    """
    criteria = _read(tables, where)
    _check_controllers(criteria, where)
    return criteria


def _read(tables: Sequence[Mapping[str, Any]], where: str) -> tuple[Criterion, ...]:
    try:
        return read_criteria(tables)
    except CriterionError as error:
        raise InputError(f"{where}: {error}") from error


def _check_names(criteria: Sequence[Criterion], matrix: Matrix, wishes: Wishes, where: str) -> None:
    """Refuse criteria that judge no run, unless the options narrow the target."""
    _check_controllers(criteria, where)
    scenarios = sorted({one.scenario_name for one in matrix.configurations})
    controllers = sorted({one.controller for one in matrix.configurations})
    for one in criteria:
        if wishes.narrows() or any(_applying([one], each) for each in matrix.configurations):
            continue
        raise InputError(
            f"{where}: the criterion {one.id!r} judges no run; there are the scenarios "
            f"{', '.join(scenarios)} and the controllers {', '.join(controllers)}"
        )


def _check_controllers(criteria: Sequence[Criterion], where: str) -> None:
    known = {each.name for each in inventory.controllers()}
    for one in criteria:
        for name in one.controllers:
            if name not in known:
                raise InputError(
                    f"{where}: the criterion {one.id!r} names the controller {name!r}, which does not exist; "
                    f"there are {', '.join(sorted(known))}"
                )
