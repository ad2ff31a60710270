"""Compares two controllers on the same seeds, from the folders of their runs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError, did_you_mean
from analysis.results.measures import Measure, run_measures
from analysis.study.comparison_rows import Pairs, compare_labels, correct, pair_runs, shared_conditions
from analysis.study.design import Condition, Study, read_study
from analysis.study.runs import StudyRun, find_run_folders
from analysis.study.writing import write_comparison
from cosim.errors import InputError


@dataclass(frozen=True, slots=True)
class CompareRequest:
    """A user's request for a comparison."""

    folder: Path
    alt: str
    base: str = "sumo"
    metrics: tuple[str, ...] = ()
    """Names of measures; empty for the key ones."""
    scenario: str | None = None
    each: bool = False
    """Whether to make one table for each setting of a scenario."""
    chosen: tuple[Path, ...] | None = None
    """Folders of the runs; ``None`` for all runs below the folder."""


@dataclass(frozen=True, slots=True)
class Compared:
    """One table of a comparison, on a scenario or on one setting of it."""

    rows: Sequence[Mapping[str, Any]]
    pairs: Pairs

    @property
    def runs(self) -> list[StudyRun]:
        """The runs that were compared."""
        return [run for side in (*self.pairs.base, *self.pairs.alt) for run in side]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Result of a comparison."""

    folder: Path
    base: str
    """Label of the controller, as the analysis writes it."""
    alt: str
    measures: Mapping[str, Measure]
    tables: Sequence[Compared]
    left_out: Sequence[Condition]
    """Conditions in which no common seed has valid runs."""
    study: Study

    def write(self) -> Path:
        """Write the rows of all tables, and return the file.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        path = self.folder / f"comparison-{_file_name(self.base)}-{_file_name(self.alt)}.csv"
        try:
            write_comparison(path, [dict(row) for one in self.tables for row in one.rows])
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}") from error
        return path


def compare_runs(request: CompareRequest) -> Comparison:
    """Compare two controllers on the seeds that both have.

    Raises
    ------
    InputError
        If there is no such folder, controller, measure or scenario, or no seed in common.
    """
    folder = request.folder
    study = _study_in(folder, request.chosen)
    base, alt = _label(study, folder, "--base", request.base), _label(study, folder, "--alt", request.alt)
    if base == alt:
        raise InputError(
            f"--base {request.base} and --alt {request.alt} are the same; available: {_all(study)}"
        )
    chosen = _measures(request.metrics)
    tables: list[Compared] = []
    left_out: list[Condition] = []
    for scope in _scopes(study, request.scenario, request.each):
        rows = compare_labels(study, scope, base, alt, chosen)
        pairs = pair_runs(study, shared_conditions(study, scope, base, alt), base, alt)
        if not pairs.base:
            left_out += scope
            continue
        correct(rows, "chosen" if request.metrics else "key")
        tables.append(Compared(rows, pairs))
    if not tables:
        raise InputError(_nothing_in_common(study, folder, base, alt))
    return Comparison(
        folder, base, alt, {measure.name: measure for measure in chosen}, tables, left_out, study
    )


def _study_in(folder: Path, chosen: tuple[Path, ...] | None) -> Study:
    try:
        study = read_study(find_run_folders(folder) if chosen is None else chosen)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder")
    if not study.runs:
        raise InputError(
            f"{folder}: contains no runs; expected the folder of a study or a folder of run folders"
        )
    return study


def _label(study: Study, folder: Path, flag: str, name: str) -> str:
    labels = study.matching(name)
    if not labels:
        raise InputError(f"{flag} {name}: no run of it in {folder}; available: {_all(study)}")
    if len(labels) > 1:
        raise InputError(f"{flag} {name} is ambiguous: {', '.join(map(repr, labels))}")
    return labels[0]


def _all(study: Study) -> str:
    return ", ".join(repr(label) if " " in label else label for label in study.all_labels())


def _measures(names: Sequence[str]) -> list[Measure]:
    known = {measure.name: measure for measure in run_measures()}
    if not names:
        return [measure for measure in known.values() if measure.key]
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known)
            keys = ", ".join(measure.name for measure in known.values() if measure.key)
            raise InputError(
                f"--metric {name}: no such measure; {hint}available: the key measures ({keys}), the other "
                "shares and rates of docs/statistics.md, and all numbers of runs.csv except wall-clock times"
            )
    return [known[name] for name in dict.fromkeys(names)]


def _scopes(study: Study, scenario: str | None, each: bool) -> list[list[Condition]]:
    names = sorted({one.scenario_id for one in study.conditions})
    if scenario is not None and scenario not in names:
        raise InputError(f"--scenario {scenario}: no run of it; available: {', '.join(names)}")
    chosen = [one for one in study.conditions if scenario in (None, one.scenario_id)]
    if each:
        return [[one] for one in chosen]
    return [found for name in names if (found := [one for one in chosen if one.scenario_id == name])]


def _nothing_in_common(study: Study, folder: Path, base: str, alt: str) -> str:
    if any(pair_runs(study, [one], base, alt).base for one in study.conditions):
        return (
            f"{folder}: no seed was run under all settings of a scenario; --each compares setting by setting"
        )
    said = []
    for label in (base, alt):
        runs = [run for run in study.runs if study.label(run) == label]
        where = ", ".join(sorted({run.scenario_id for run in runs}))
        said.append(f"{label} has {_seeds(sorted({run.seed for run in runs if run.valid}))} on {where}")
    return f"{folder}: no seed in common under the same settings with valid runs: {'; '.join(said)}"


def _seeds(seeds: list[int]) -> str:
    if not seeds:
        return "no valid run"
    shown = ", ".join(map(str, seeds[:10])) + (", …" if len(seeds) > 10 else "")
    return f"seed{'s' if len(seeds) > 1 else ''} {shown}"


def _file_name(label: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.=]+", "_", label)
