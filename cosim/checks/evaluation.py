"""Holds the finished runs of a target against its criteria."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.criteria.criterion import Cells, Criterion, chosen_rows, judge, row_value, statistic_value
from analysis.files import read_csv
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.study.tables import CONFIGS
from cosim.batches.batch import Batch
from cosim.batches.job import Configuration, Job
from cosim.batches.ledger import FAILED
from cosim.batches.ledger import RUNS as RUN_FOLDERS
from cosim.checks.finding import VALID, Finding
from cosim.checks.target import Target

if TYPE_CHECKING:
    from cosim.suites.judging import Case, Verdict

MOST_SEEDS = 10
"""Named in a note."""


@dataclass(frozen=True, slots=True)
class Made:
    """Outcome of a run."""

    job: Job
    folder: Path | None
    """Of a run that went to its end; ``None`` for others."""
    place: str
    """Folder in that of the check."""
    reason: str
    """Why it is not valid; empty for a valid run."""
    description: Mapping[str, Any]


class Evaluation:
    """The findings of a target whose batch has ended.

    Parameters
    ----------
    target : Target
    batch : Batch
    stopped : str
        Why the batch ended early; empty if it did not.
    command : str
        Makes the whole check again.
    """

    def __init__(self, target: Target, batch: Batch, stopped: str, command: str) -> None:
        self._command = command
        self._target = target
        self._batch = batch
        self._stopped = stopped

    def findings(self) -> list[Finding]:
        """Return everything, in a fixed order."""
        return [row for one in self._batch.matrix.configurations for row in self._configuration(one)]

    def made(self, one: Configuration) -> list[Made]:
        """Return the runs of a configuration in the order of their seeds."""
        return [self._made(Job(one, seed)) for seed in self._batch.matrix.seeds]

    def origin(self, one: Configuration) -> Finding:
        """Return a finding that holds only its origin."""
        varied = " ".join(f"{key}={value}" for key, value in one.varied)
        return Finding(
            target=self._target.name,
            scenario_id=one.scenario_name,
            controller=one.controller,
            configuration=f"{one.controller} {varied}".strip(),
            scope="run",
            criterion_id=VALID,
            metric=VALID,
            status="pass",
        )

    def _configuration(self, one: Configuration) -> Iterator[Finding]:
        made = self.made(one)
        origin = self.origin(one)
        yield from (_validity(origin, run) for run in made)
        if one.scenario in self._target.cases:
            yield from (self._case(origin, run) for run in made)
        for criterion in self._target.criteria[one]:
            about = _about(origin, criterion)
            if criterion.scope == "configuration":
                yield self._statistic(about, criterion, made)
            else:
                for run in made:
                    yield from _judged_rows(about, criterion, run)

    def _statistic(self, about: Finding, criterion: Criterion, made: list[Made]) -> Finding:
        valid = [run for run in made if not run.reason]
        about = replace(about, n_runs=len(valid), command=self._command)
        if len(valid) < len(made):
            first = next(run for run in made if run.reason)
            lost = f"{len(made) - len(valid)} of {len(made)} runs are not valid, for instance seed "
            return replace(about, status="invalid", note=f"{lost}{first.job.seed}: {first.reason}")
        config_id = str(valid[0].description["config_id"])
        row = self._statistics[config_id, criterion.metric, criterion.kind]
        found = judge(criterion, statistic_value(criterion, row))
        note = "" if found.value is not None else f"{row['status']}, {row['n_defined']} runs have a value; "
        seeds = ", ".join(str(run.job.seed) for run in made[:MOST_SEEDS])
        note += f"over {len(made)} runs, seeds {seeds}" + (", …" if len(made) > MOST_SEEDS else "")
        return replace(
            about,
            status=found.status,
            value=found.value,
            margin=found.margin,
            counts=not (found.status == "undefined" and criterion.allow_undefined),
            note=note,
        )

    def _case(self, origin: Finding, run: Made) -> Finding:
        """Return the verdict of a test protocol on a run."""
        case = self._target.cases[run.job.configuration.scenario]
        about = replace(
            _of_run(origin, run),
            scope="case",
            criterion_id=f"protocol {case.name}",
            metric="impact_speed_kmh",
            unit="km/h",
        )
        if run.reason:
            return replace(about, status="invalid", note=run.reason)
        return with_verdict(about, case, self._verdicts[run.job])

    @cached_property
    def _verdicts(self) -> Mapping[Job, Verdict]:
        """Return the verdicts on all valid runs; some cases are held against the standard one beside them."""
        from cosim.suites import judging

        groups: dict[object, list[tuple[Job, Case, Verdict]]] = {}
        for one in self._batch.matrix.configurations:
            case = self._target.cases[one.scenario]
            for run in self.made(one):
                if run.folder is not None and not run.reason:
                    together = one.controller, one.settings, one.sensing, run.job.seed
                    verdict = judging.judge(run.folder, case)
                    groups.setdefault(together, []).append((run.job, case, verdict))
        return {
            job: verdict
            for group in groups.values()
            for (job, _, _), (_, verdict) in zip(
                group, judging.settled((case, one) for _, case, one in group), strict=True
            )
        }

    @cached_property
    def _statistics(self) -> Mapping[tuple[str, str, str], Cells]:
        rows = read_csv(self._batch.ledger.folder / CONFIGS.file)
        return {(row["config_id"], row["metric"], row["kind"]): row for row in rows}

    @cached_property
    def _finished(self) -> frozenset[str]:
        return frozenset(self._batch.ledger.finished())

    @cached_property
    def _failures(self) -> Mapping[str, str]:
        return {str(one["run"]): str(one["reason"]) for one in self._batch.ledger.failures()}

    def _made(self, job: Job) -> Made:
        damaged = self._batch.ledger.damaged
        if job.name in damaged:
            return Made(job, None, "", f"damaged: {damaged[job.name]}", {})
        if job.name in self._finished:
            description = self._batch.ledger.description(job.name)
            reason = "" if description["valid"] else str(description["invalid_reason"])
            place = f"{self._target.name}/{RUN_FOLDERS}/{job.name}"
            return Made(job, self._batch.ledger.run_folder(job.name), place, reason, description)
        if job.name in self._failures:
            failed_in = f"{self._target.name}/{FAILED}/{job.name}"
            return Made(job, None, failed_in, self._failures[job.name] or "failed", {})
        return Made(job, None, "", f"not made: {self._stopped or 'the batch ended before it'}", {})


def _about(origin: Finding, criterion: Criterion) -> Finding:
    return replace(
        origin,
        scope=criterion.scope,
        criterion_id=criterion.id,
        metric=criterion.metric,
        statistic=criterion.statistic or None,
        unit=criterion.unit,
        operator=criterion.operator,
        threshold=criterion.threshold,
    )


def _of_run(about: Finding, run: Made) -> Finding:
    return replace(about, seed=run.job.seed, run=run.place or None, command=run.job.command())


def _validity(origin: Finding, run: Made) -> Finding:
    return replace(_of_run(origin, run), status="invalid" if run.reason else "pass", note=run.reason or None)


def _judged_rows(about: Finding, criterion: Criterion, run: Made) -> Iterator[Finding]:
    """Return a finding for each row that is judged, or one that says why there is none."""
    about = _of_run(about, run)
    if run.reason or run.folder is None:
        yield replace(about, status="invalid", note=run.reason)
        return
    table = ENCOUNTERS if criterion.scope == "encounter" else RUNS
    rows = chosen_rows(criterion, read_csv(run.folder / table.file))
    counts = not criterion.allow_undefined
    if not rows:
        yield replace(about, status="undefined", counts=counts, note=f"no {criterion.scope} to judge")
    for row in rows:
        found = judge(criterion, row_value(criterion, row))
        judged = replace(
            about,
            status=found.status,
            value=found.value,
            margin=found.margin,
            counts=counts or found.status != "undefined",
        )
        yield _of_encounter(judged, row) if criterion.scope == "encounter" else judged


def _of_encounter(judged: Finding, row: Cells) -> Finding:
    return replace(
        judged,
        encounter_id=int(row["encounter_id"]),
        ego_id=row["ego_id"],
        ped_id=row["ped_id"],
        t_start_s=float(row["t_start_s"]),
    )


def with_verdict(about: Finding, case: Case, verdict: Verdict) -> Finding:
    """Return the finding with the verdict of a protocol; what could not be prevented does not count."""
    notes = [f"expected {case.group.rule.replace('_', ' ')}", verdict.note]
    limit, speed = case.highest_impact_kmh, verdict.impact_speed_kmh
    if limit is not None:
        about = replace(
            about, operator="<=", threshold=limit, margin=None if speed is None else limit - speed
        )
        notes = [verdict.note]
    if not verdict.passed and not verdict.counts:
        notes.append("not preventable, so it does not count")
    return replace(
        about,
        status="pass" if verdict.passed else "fail",
        counts=verdict.passed or verdict.counts,
        value=speed,
        colour=verdict.colour or None,
        points=verdict.points,
        note="; ".join(filter(None, notes)) or None,
    )
