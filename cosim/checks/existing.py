"""Judges existing runs without simulating any: ``cosim check --results``."""

from __future__ import annotations

import shlex
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.criteria.criterion import Criterion
from analysis.errors import AnalysisError
from analysis.files import PART, read_json
from analysis.study.configuration_rows import configuration_rows
from analysis.study.design import Study, read_study
from analysis.study.runs import STUDY_FILE, StudyRun, find_run_folders
from analysis.study.tables import CONFIGS
from analysis.tables.cells import cells
from cosim.batches.criteria_file import tables_in
from cosim.batches.ledger import FAILED
from cosim.batches.outcome import NOTE
from cosim.batches.stored import DAMAGED, read_failure
from cosim.batches.study import parse_seeds
from cosim.batches.study import read_study as read_study_file
from cosim.checks.finding import VALID, Finding
from cosim.checks.judged import (
    Made,
    Statistics,
    about_case,
    judged_rows,
    judged_statistic,
    validity,
    with_culprit,
    with_verdict,
)
from cosim.checks.target import SUITE, criteria_of_scenario, criteria_of_tables
from cosim.checks.unstarted import Pair, Varied, unstarted
from cosim.errors import InputError, SimulationError
from sumo_scenarios import library

_Key = tuple[str, str, str]
"""Scenario, controller and label of a configuration."""


@dataclass(frozen=True, slots=True)
class Results:
    """A folder with runs, and the file with the criteria that judge them."""

    folder: Path
    criteria: Path | None = None
    """``None`` for the criteria of the study file beside the runs or, without one, those of each scenario."""

    def command(self) -> str:
        """Return the command that judges the same runs again."""
        words = ["cosim", "check", "--results", str(self.folder)]
        return shlex.join(words + ([] if self.criteria is None else ["--criteria", str(self.criteria)]))


def judge_results(results: Results) -> list[Finding]:
    """Judge every run at or below a folder, in a fixed order.

    Raises
    ------
    InputError
        If there is no run, a run cannot be read, or no run has a criterion.
    SimulationError
        If the file that describes a failed run cannot be read.
    """
    folder = results.folder
    if not folder.is_dir():
        raise InputError(f"--results {folder}: no such folder")
    found: list[Finding] = []
    cases: list[tuple[Finding, Made]] = []
    judged_by_any = False
    for place, runs in _studies(folder).items():
        study = _read(runs)
        by_configuration = _made(study, place, folder)
        rows = cells(CONFIGS, list(configuration_rows(study)), number="{:.6g}".format)
        statistics = {
            (row["config_id"], row["metric"], row["kind"]): row
            for row in (dict(zip(CONFIGS.names(), row, strict=True)) for row in rows)
        }
        target = place.resolve().name
        for (scenario, controller, label), made in sorted(by_configuration.items()):
            criteria = _criteria(results, place, scenario, controller, made)
            judged_by_any |= bool(criteria)
            origin = Finding(
                target=target,
                scenario_id=scenario,
                controller=controller,
                configuration=label,
                scope="run",
                criterion_id=VALID,
                metric=VALID,
                status="pass",
                command=results.command(),
            )
            found += _findings(origin, criteria, made, statistics)
            cases += [(origin, run) for run in made]
    if not found:
        raise InputError(
            f"--results {folder}: contains no runs; expected the folder of a run, batch or check"
        )
    verdicts = list(_with_cases(cases))
    if not judged_by_any and not verdicts:
        raise InputError(
            f"--results {folder}: no criterion in its study file or in the scenarios; "
            "name a file with --criteria"
        )
    return sorted([*found, *verdicts], key=lambda one: one.target)


def _findings(
    origin: Finding, criteria: Sequence[Criterion], made: Sequence[Made], statistics: Statistics
) -> Iterator[Finding]:
    yield from (validity(origin, run) for run in made)
    for criterion in criteria:
        if criterion.scope == "configuration":
            yield judged_statistic(origin, criterion, made, statistics)
        else:
            for run in made:
                yield from judged_rows(origin, criterion, run)


def _studies(folder: Path) -> Mapping[Path, Sequence[Path]]:
    """Return the runs that belong together, by folder: those of each study, and all others."""
    if (folder / STUDY_FILE).is_file():
        return {folder: find_run_folders(folder)}
    runs = find_run_folders(folder)
    found: dict[Path, list[Path]] = {}
    for path in sorted(folder.rglob(STUDY_FILE)):
        if not any(part.startswith(".") or part.endswith(PART) for part in path.relative_to(folder).parts):
            found.setdefault(path.parent, [])
    for run in runs:
        inner = next((one for one in run.parents if one in found), folder)
        found.setdefault(inner, []).append(run)
    return found


def _add_missing(made: dict[_Key, list[Made]], begun: Mapping[Pair, list[Varied]], place: Path) -> None:
    """Add what the study file asks for and was never run: an interrupted batch."""
    file = place / STUDY_FILE
    if not file.is_file():
        return
    study = read_study_file(file, allow_programs=True)  # nothing is run
    for (scenario, controller), varied in unstarted(study, begun):
        made.setdefault((scenario, controller, _name_of(controller, varied)), [])
    for seed in parse_seeds(study.seeds):
        for runs in made.values():
            if seed not in {one.seed for one in runs}:
                runs.append(Made(seed, "", None, "", "was not made", {"place": None}))


def _read(folders: Sequence[Path]) -> Study:
    try:
        study = read_study(folders)
    except AnalysisError as error:
        raise InputError(f"--results: {error}") from error
    for told in study.unreadable.values():
        raise InputError(f"--results: {told}")
    return study


def _made(study: Study, place: Path, root: Path) -> Mapping[_Key, list[Made]]:
    """Return the runs of each configuration, including those that failed in a batch or were never made."""
    found: dict[_Key, list[Made]] = {}
    labels: dict[object, str] = {}
    begun: defaultdict[Pair, list[Varied]] = defaultdict(list)
    for run in study.runs:
        if run.folder.is_relative_to(place / FAILED):
            continue  # files of a failed run, whose own file says why it failed
        reason = "" if run.valid else run.invalid_reason or "the run did not end"
        note = _noted(run.folder)
        begun[run.scenario_id, str(note.get("controller", run.controller))].append(note.get("varied", {}))
        label = labels[_asked_for(run.scenario_id, run.controller, note)] = _label(study, run)
        found.setdefault((run.scenario_id, run.controller, label), []).append(
            Made(
                run.seed,
                str(note.get("command", "")),
                run.folder,
                _relative(run.folder, root),
                reason,
                {"config_id": run.config_id, "place": note.get("place")},
            )
        )
    for folder in sorted(path for path in (place / FAILED).glob("*") if path.is_dir()):
        failure = read_failure(folder)
        if failure.get(DAMAGED):
            raise SimulationError(failure["reason"])
        scenario, controller = failure["scenario"], failure["controller"]
        asked_for = _asked_for(scenario, controller, failure)
        varied = failure.get("varied", {})
        begun[scenario, controller].append(varied)
        label = labels.get(asked_for, _name_of(controller, varied))
        lost = Made(
            failure["seed"],
            failure["command"],
            None,
            _relative(folder, root),
            failure["reason"] or "failed",
            {"place": failure.get("place")},
        )
        found.setdefault((scenario, controller, label), []).append(lost)
    if found or place != root:
        _add_missing(found, begun, place)
    return {key: sorted(made, key=lambda one: one.seed) for key, made in found.items()}


def _asked_for(scenario: str, controller: str, note: Mapping[str, Any]) -> object:
    """Return what distinguishes the configurations of a study, for finished and for failed runs."""
    return scenario, controller, tuple(sorted(note.get("varied", {}).items()))


def _name_of(controller: str, varied: Varied) -> str:
    return " ".join([controller, *(f"{key}={value}" for key, value in varied.items())])


def _label(study: Study, run: StudyRun) -> str:
    condition = next(one for one in study.conditions if one.condition_id == run.condition_id)
    return f"{study.label(run)} {condition.text}".strip()


def _relative(folder: Path, root: Path) -> str:
    name = folder.resolve().relative_to(root.resolve()).as_posix()
    return "" if name == "." else name


def _noted(folder: Path) -> Mapping[str, Any]:
    """Return how a study asked for a run; empty for a run that no study asked for."""
    try:
        return dict(read_json(folder / NOTE))
    except (OSError, ValueError):
        return {}


def _criteria(
    results: Results, place: Path, scenario: str, controller: str, made: Sequence[Made]
) -> tuple[Criterion, ...]:
    every: tuple[Criterion, ...] = ()
    file = place / STUDY_FILE
    if results.criteria is not None:
        every = criteria_of_tables(tables_in(results.criteria), str(results.criteria))
    else:
        study = read_study_file(file, allow_programs=True) if file.is_file() else None  # nothing is run
        if study is not None and study.criteria:
            every = criteria_of_tables(study.criteria, str(file))
        else:
            # A study names its scenarios relative to its original file, which was in another folder.
            places = dict.fromkeys(str(one.description["place"]) for one in made if one.description["place"])
            every = _of_scenario([*places, *([scenario] if study is None else study.scenarios)], scenario)
    return tuple(one for one in every if one.applies_to(scenario, controller))


def _of_scenario(references: Sequence[str], scenario: str) -> tuple[Criterion, ...]:
    """Return the criteria of the scenario with that name; none if it no longer exists."""
    for reference in references:
        try:
            if library.load(reference).name == scenario:
                return criteria_of_scenario(reference, scenario)
        except ValueError:
            continue
    return ()


def _with_cases(found: list[tuple[Finding, Made]]) -> Iterator[Finding]:
    """Return the verdicts on those runs whose notes name a case of a test protocol."""
    from cosim.suites import judging

    groups: dict[tuple[str, int], list[tuple[Finding, Made, judging.Case, judging.Verdict]]] = {}
    for origin, run in found:
        reference = _noted(run.folder).get("scenario", "") if run.folder else ""
        if run.folder is None or not str(reference).startswith(SUITE):
            continue
        (case,) = judging.cases(str(reference))
        about = about_case(origin, case, run)
        if run.reason:
            yield replace(about, status="invalid", note=run.reason)
            continue
        verdict = judging.judge(run.folder, case)
        groups.setdefault((origin.configuration, run.seed), []).append((about, run, case, verdict))
    for group in groups.values():
        settled = judging.settled((case, verdict) for _, _, case, verdict in group)
        for (about, run, case, _), (_, verdict) in zip(group, settled, strict=True):
            if run.folder is not None:
                yield with_culprit(with_verdict(about, case, verdict), run.folder, {})
