"""Compares runs with those of an earlier check or batch that were made for the same request."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError
from analysis.files import read_json
from analysis.results.measures import run_measures
from analysis.study.regression import Pairing, regression_rows
from analysis.study.runs import StudyRun, find_run_folders, read_runs
from cosim.batches.batch import Batch
from cosim.batches.identity import Identity
from cosim.batches.job import Configuration, Job
from cosim.batches.matrix import Matrix
from cosim.batches.outcome import NOTE
from cosim.checks.evaluation import Evaluation
from cosim.checks.finding import Finding
from cosim.errors import InputError

FEWEST_SEEDS = 2
"""Smallest number of common seeds for a test."""
_SAME = ("egos", "inputs", "step_s", "warmup_s", "requested_duration_s", "actuation", "sensing")
"""Keys of ``run.json`` that must be equal in both runs; the controller and the versions may differ."""

Asked = tuple[str, str, tuple[tuple[str, str], ...], str | None, int]


@dataclass(frozen=True, slots=True)
class Baseline:
    """Valid earlier runs, by their request."""

    folder: Path
    runs: Mapping[Asked, tuple[StudyRun, Mapping[str, Any]]]
    """Each run with the content of its ``run.json``."""

    def seeds(self, one: Configuration, seeds: Sequence[int]) -> list[int]:
        """Return those of the seeds with which this configuration was run earlier."""
        return [seed for seed in seeds if _asked(Job(one, seed)) in self.runs]

    def then(self, one: Configuration, seeds: Sequence[int]) -> list[StudyRun]:
        """Return the earlier runs of a configuration with these seeds."""
        return [self.runs[_asked(Job(one, seed))][0] for seed in seeds]


def read_baseline(folder: Path) -> Baseline:
    """Return the valid runs in the folder of an earlier check or batch.

    Raises
    ------
    InputError
        If the folder has no runs, or they cannot be read.
    """
    if not folder.is_dir():
        raise InputError(f"--baseline {folder}: no such folder")
    folders = [path for path in find_run_folders(folder) if (path / NOTE).is_file()]
    if not folders:
        raise InputError(
            f"--baseline {folder}: contains no runs; expected the folder of an earlier check or batch"
        )
    try:
        runs = [run for run in read_runs(folders) if run.valid]
        found = {}
        for run in runs:
            note = read_json(run.folder / NOTE)
            description = read_json(run.folder / "run.json")
            settings = tuple(sorted((str(key), str(value)) for key, value in note["settings"].items()))
            sensing = dict(note["varied"]).get("sensing")
            found[run.scenario_id, run.controller, settings, sensing, run.seed] = run, description
    except (AnalysisError, OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"--baseline {folder}: cannot be read: {error}") from error
    return Baseline(folder, found)


def check_common(baseline: Baseline, matrices: Sequence[Matrix]) -> None:
    """Refuse a baseline that has too little in common with the runs to be made.

    Raises
    ------
    InputError
        If no configuration shares two seeds with it.
    """
    common = [len(baseline.seeds(one, matrix.seeds)) for matrix in matrices for one in matrix.configurations]
    most = max(common, default=0)
    if most == 0:
        there = sorted({f"{key[0]} with {key[1]}" for key in baseline.runs}) or ["no valid run"]
        raise InputError(
            f"--baseline {baseline.folder} belongs to another study: no run of the same scenario, "
            f"controller, settings and seed in it; there are {', '.join(there[:8])}"
        )
    if most < FEWEST_SEEDS:
        raise InputError(
            f"--baseline {baseline.folder}: expected at least {FEWEST_SEEDS} seeds in common for a test, "
            "there is one; --seeds 1-10 makes ten runs"
        )


def check_same_road(baseline: Baseline, batches: Sequence[Batch]) -> None:
    """Refuse a baseline whose runs were made on other roads or with other demand.

    Raises
    ------
    InputError
        If they were; names the first difference.
    """
    for batch in batches:
        for one in batch.matrix.configurations:
            for seed in baseline.seeds(one, batch.matrix.seeds)[:1]:
                job = Job(one, seed)
                if told := _different(batch.checked.identity(job), baseline.runs[_asked(job)][1]):
                    raise InputError(
                        f"--baseline {baseline.folder} belongs to another study: {one.label}: {told}"
                    )


def compare(
    baseline: Baseline, evaluations: Sequence[tuple[Evaluation, Batch]], level: float, command: str
) -> list[Finding]:
    """Return a finding for each configuration and key measure; one for a configuration without a baseline.

    Raises
    ------
    InputError
        If the baseline was judged with other thresholds.
    """
    origins: list[Finding] = []
    pairings: list[Pairing] = []
    without: list[Finding] = []
    for evaluation, batch in evaluations:
        for one in batch.matrix.configurations:
            valid = {run.seed: run for run in evaluation.made(one) if not run.reason}
            seeds = baseline.seeds(one, list(valid))
            if len(baseline.seeds(one, batch.matrix.seeds)) < FEWEST_SEEDS:
                without.append(_without(replace(evaluation.origin(one), command=command)))
                continue
            folders = [folder for seed in seeds if (folder := valid[seed].folder) is not None]
            pairing = Pairing(baseline.then(one, seeds), read_runs(folders))
            if len({run.thresholds for run in (*pairing.then, *pairing.now)} - {""}) > 1:
                raise InputError(
                    f"--baseline {baseline.folder}: was judged with other thresholds than these runs; "
                    "cosim analyse judges its runs anew"
                )
            pairings.append(pairing)
            origins.append(replace(evaluation.origin(one), command=command))
    measures = [one for one in run_measures() if one.key]
    groups = regression_rows(pairings, measures, level)
    found = [
        _finding(origin, row, level) for origin, rows in zip(origins, groups, strict=True) for row in rows
    ]
    return [*found, *without]


def _without(origin: Finding) -> Finding:
    return replace(
        origin,
        scope="baseline",
        criterion_id="not worse than the baseline",
        metric="baseline",
        status="undefined",
        counts=False,
        note="fewer than two seeds of this configuration are in the baseline; not compared",
    )


def _finding(origin: Finding, row: Mapping[str, Any], level: float) -> Finding:
    about = replace(
        origin,
        scope="baseline",
        criterion_id=f"{row['metric']} not worse than the baseline",
        metric=row["metric"],
        statistic="difference",
        unit=row["unit"],
        n_runs=row["n_pairs"],
        value=row["diff_mean"],
        p_holm=row["p_holm"],
    )
    if row["diff_mean"] is None:
        return replace(about, status="undefined", counts=False, note="undefined in the pairs; not compared")
    return replace(about, status="fail" if row["worse_now"] else "pass", note=_told(row, level))


def _told(row: Mapping[str, Any], level: float) -> str:
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    said = f"{row['metric']} {row['base_mean']:.6g} → {row['alt_mean']:.6g}{unit}, {row['n_pairs']} pairs"
    if row["p_holm"] is None:
        return f"{said}, {'no difference' if row['diff_mean'] == 0.0 else 'no test'}"
    said += f", {row['test']} p = {row['p_value']:.3g}, "
    said += f"{row['p_holm']:.3g} corrected over {row['n_family']} tests"
    return f"{said}: {'worse' if row['worse_now'] else 'not shown to be worse'} at level {level:g}"


def _asked(job: Job) -> Asked:
    one = job.configuration
    sensing = dict(one.varied).get("sensing")
    settings = tuple(sorted(one.settings))
    return one.scenario_name, one.controller, settings, sensing, job.seed


def _different(now: Identity, then: Mapping[str, Any]) -> str:
    """Return the first difference because of which the runs cannot be paired; empty if there is none."""
    mine = now.description
    for key in _SAME:
        if mine[key] == then.get(key):
            continue
        if key != "inputs":
            return f"{key} was {then.get(key)}, it is {mine[key]}"
        before: Mapping[str, str] = then.get(key) or {}
        files = sorted({*before, *mine[key]})
        changed = [name for name in files if before.get(name) != mine[key].get(name)]
        return f"the input {changed[0]} had another content"
    for part in ("scenario", "sensing"):
        ours, theirs = mine["parameters"].get(part) or {}, (then.get("parameters") or {}).get(part) or {}
        for name in sorted({*ours, *theirs}):
            if ours.get(name) != theirs.get(name):
                return f"the parameter {name} was {theirs.get(name)}, it is {ours.get(name)}"
    return ""
