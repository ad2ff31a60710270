"""Judges the finished runs of a target by its criteria."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from analysis.criteria.criterion import Cells
from analysis.files import read_csv
from analysis.study.tables import CONFIGS
from cosim.batches.batch import Batch
from cosim.batches.job import Configuration, Job
from cosim.batches.ledger import FAILED
from cosim.batches.ledger import RUNS as RUN_FOLDERS
from cosim.checks.finding import VALID, Finding
from cosim.checks.judged import (
    Made,
    about_case,
    judged_rows,
    judged_statistic,
    validity,
    with_culprit,
    with_verdict,
)
from cosim.checks.target import Target

if TYPE_CHECKING:
    from cosim.suites.judging import Case, Verdict


class Evaluation:
    """The findings of a target whose batch has ended.

    Parameters
    ----------
    target : Target
    batch : Batch
    stopped : str
        Why the batch ended early; empty if it did not.
    command : str
        Command that repeats the whole check.
    """

    def __init__(self, target: Target, batch: Batch, stopped: str, command: str) -> None:
        self._command = command
        self.target = target
        self._batch = batch
        self._stopped = stopped

    @property
    def configurations(self) -> Sequence[Configuration]:
        """Configurations that were run."""
        return self._batch.matrix.configurations

    def findings(self) -> list[Finding]:
        """Return all findings, in a fixed order."""
        return [row for one in self.configurations for row in self._configuration(one)]

    def made(self, one: Configuration) -> list[Made]:
        """Return the runs of a configuration in the order of their seeds."""
        return [self._made(Job(one, seed)) for seed in self._batch.matrix.seeds]

    def origin(self, one: Configuration) -> Finding:
        """Return a finding that only says which configuration it is about."""
        varied = " ".join(f"{key}={value}" for key, value in one.varied)
        return Finding(
            target=self.target.name,
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
        yield from (validity(origin, run) for run in made)
        if one.scenario in self.target.cases:
            yield from (self._case(origin, one, run) for run in made)
        for criterion in self.target.criteria[one]:
            if criterion.scope == "configuration":
                about = replace(origin, command=self._command)
                yield judged_statistic(about, criterion, made, self._statistics)
            else:
                for run in made:
                    yield from judged_rows(origin, criterion, run)

    def _case(self, origin: Finding, one: Configuration, run: Made) -> Finding:
        """Return the verdict of a test protocol on a run."""
        case = self.target.cases[one.scenario]
        about = about_case(origin, case, run)
        if run.reason:
            return replace(about, status="invalid", note=run.reason)
        found = with_verdict(about, case, self.verdicts[Job(one, run.seed)])
        return found if run.folder is None else with_culprit(found, run.folder, {})

    @cached_property
    def verdicts(self) -> Mapping[Job, Verdict]:
        """Return the verdicts on all valid runs; some cases are compared with a standard case."""
        from cosim.suites import judging

        groups: dict[object, list[tuple[Job, Case, Verdict]]] = {}
        for one in self.configurations:
            case = self.target.cases[one.scenario]
            for run in self.made(one):
                if run.folder is not None and not run.reason:
                    together = one.controller, one.settings, one.sensing, run.seed
                    verdict = judging.judge(run.folder, case)
                    groups.setdefault(together, []).append((Job(one, run.seed), case, verdict))
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
            return Made(job.seed, job.command(), None, "", f"damaged: {damaged[job.name]}", {})
        if job.name in self._finished:
            description = self._batch.ledger.description(job.name)
            reason = "" if description["valid"] else str(description["invalid_reason"])
            place = f"{self.target.name}/{RUN_FOLDERS}/{job.name}"
            return Made(
                job.seed, job.command(), self._batch.ledger.run_folder(job.name), place, reason, description
            )
        if job.name in self._failures:
            failed_in = f"{self.target.name}/{FAILED}/{job.name}"
            return Made(job.seed, job.command(), None, failed_in, self._failures[job.name] or "failed", {})
        return Made(
            job.seed, job.command(), None, "", f"not made: {self._stopped or 'the batch ended before it'}", {}
        )
