"""Design of a study: conditions (scenario and setting), configurations of controllers, and pairs.

A *label* names a configuration of a controller: its name and, if the study has several parameter sets for
it, the parameters that differ. A *condition* is everything that two controllers must share to be compared:
scenario, demand, egos, step and files. Runs are paired by condition and seed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from analysis.errors import StudyError
from analysis.study.runs import StudyRun, read_whole_runs

REFERENCE = "sumo"
"""The baseline if none is named and the study has this one: SUMO's own driver."""


@dataclass(frozen=True, slots=True)
class Condition:
    """Scenario and setting of some runs."""

    condition_id: str
    scenario_id: str
    text: str
    """What distinguishes it from the study's other conditions of the scenario."""


@dataclass(frozen=True, slots=True)
class Study:
    """Runs, by condition and label."""

    runs: tuple[StudyRun, ...]
    conditions: tuple[Condition, ...]
    labels: Mapping[str, str]
    """Labels, by config_id."""
    unreadable: Mapping[Path, str] = field(default_factory=dict)
    """Folders of runs that are left out because they cannot be read or were changed after writing, each with
    one line that names the file and the remedy."""

    def label(self, run: StudyRun) -> str:
        """Return the label of a run's controller."""
        return self.labels[run.config_id]

    def all_labels(self) -> list[str]:
        """Return the labels of the study, in alphabetical order."""
        return sorted(set(self.labels.values()))

    def matching(self, name: str) -> list[str]:
        """Return the labels to which a label, a controller's name or a config_id refers."""
        return sorted(
            {self.label(run) for run in self.runs if name in (self.label(run), run.controller, run.config_id)}
        )

    def seeds(self, label: str, condition: Condition) -> dict[int, StudyRun]:
        """Return the runs of a label under a condition, valid or not, by seed."""
        return {
            run.seed: run
            for run in self.runs
            if run.condition_id == condition.condition_id and self.label(run) == label
        }

    def pairs_of_labels(self, baseline: str | None) -> list[tuple[str, str]]:
        """Return pairs (base, alternative) of a baseline and every other label.

        Without a baseline, ``sumo`` is the base if there is one. Otherwise, and if the baseline refers to all
        labels, the first label is the base.
        """
        labels = self.all_labels()
        bases = self.matching(baseline if baseline is not None else REFERENCE)
        if baseline is None and not bases:
            bases = labels
        if len(bases) == len(labels):
            bases = bases[:1]
        return [(base, alt) for base in bases for alt in labels if alt not in bases]


def read_study(folders: Iterable[Path]) -> Study:
    """Read run folders, in any order; folders that cannot be read are left out and named.

    Raises
    ------
    StudyError
        As for :func:`analysis.study.runs.read_whole_runs`, and if no run can be read.
    """
    runs, unreadable = read_whole_runs(folders)
    if unreadable and not runs:
        raise StudyError(min(unreadable.values()))
    return replace(study_of_runs(runs), unreadable=unreadable)


def study_of_runs(runs: Sequence[StudyRun]) -> Study:
    """Return runs as a study, with names that tell their conditions and controllers apart."""
    return Study(tuple(runs), _conditions(runs), _labels(runs))


def _conditions(runs: Sequence[StudyRun]) -> tuple[Condition, ...]:
    found: list[Condition] = []
    for scenario in sorted({run.scenario_id for run in runs}):
        settings = {run.condition_id: run.setting for run in runs if run.scenario_id == scenario}
        texts = _differences(_telling(settings))
        if len(set(texts.values())) < len(texts):  # same settings, other files
            texts = _differences(settings)
        found += [Condition(key, scenario, texts[key]) for key in settings]
    return tuple(sorted(found, key=lambda one: (one.scenario_id, one.text, one.condition_id)))


def _telling(settings: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    """Return the settings without file hashes and without what the name of the sensing model already says.

    Sensing models have different parameters; one with the same value wherever it exists says nothing.
    """
    values: dict[str, set[str]] = {}
    for setting in settings.values():
        for name, value in setting.items():
            values.setdefault(name, set()).add(value)
    same = {name for name, some in values.items() if name.startswith("sensing.") and len(some) == 1}
    return {
        key: {name: value for name, value in setting.items() if name != "inputs" and name not in same}
        for key, setting in settings.items()
    }


def _labels(runs: Sequence[StudyRun]) -> dict[str, str]:
    labels: dict[str, str] = {}
    for controller in {run.controller for run in runs}:
        mine = {run.config_id: run.parameters for run in runs if run.controller == controller}
        labels |= {key: f"{controller} {text}".strip() for key, text in _differences(mine).items()}
    return labels


def _differences(given: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Return for each key the values that differ between keys, as ``name=value name=value``."""
    names = sorted({name for values in given.values() for name in values})
    varied = [name for name in names if len({values.get(name) for values in given.values()}) > 1]
    return {
        key: " ".join(f"{name}={values[name]}" for name in varied if name in values)
        for key, values in given.items()
    }
