"""Checks controllers with suites, and writes the verdicts of each suite into a ``protocol.csv``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.sealing import seal
from cosim.batches.job import Job
from cosim.batches.progress import shown_checks, shown_tally
from cosim.checks.check import CheckRequest, prepared
from cosim.checks.evaluation import Evaluation
from cosim.checks.target import SUITE, Wishes
from studies.protocols.table import Row, write

RUN_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True)
class Driven:
    """Results of suites that were driven."""

    rows: Sequence[Row]
    files: Sequence[Path]
    exit_code: int
    """Exit code as of ``cosim check``."""


def drive(
    suites: Sequence[str],
    controllers: Sequence[str],
    out: Path,
    part: str | None = None,
    jobs: int | None = None,
) -> Driven:
    """Check suites with controllers into a folder, and write the verdicts there.

    Parameters
    ----------
    suites : names of suites
    controllers : names of controllers
    out : folder of the check, which is resumed if it exists
    part : select only cases whose name contains this text or matches this pattern
    jobs : number of runs at a time; by default one per core

    Raises
    ------
    InputError
        For an unknown suite, case or controller, or a folder with other content; nothing is simulated then.
    """
    wishes = Wishes(controllers=tuple(controllers), part=part, run_timeout_s=RUN_TIMEOUT_S)
    request = CheckRequest(tuple(f"{SUITE}{name}" for name in suites), out, wishes=wishes, jobs=jobs)
    with prepared(request, shown_checks()) as check:
        result = check.run(shown_tally)
    rows, files = [], []
    for evaluation in result.evaluations:
        mine = list(_rows(evaluation))
        rows += mine
        file = write(out / evaluation.target.name, mine)
        seal(file.parent, [file])
        files.append(file)
    return Driven(rows, files, result.exit_code)


def _rows(evaluation: Evaluation) -> Iterator[Row]:
    configurations = evaluation.configurations
    for controller in dict.fromkeys(one.controller for one in configurations):
        for one in (each for each in configurations if each.controller == controller):
            case = evaluation.target.cases[one.scenario]
            for run in evaluation.made(one):
                verdict = evaluation.verdicts.get(Job(one, run.seed))
                yield Row(
                    *(case.suite, case.name, case.group.name, controller, run.seed, case.ego_speed_kmh),
                    *(case.group.description, case.group.share, verdict, run.reason),
                )
