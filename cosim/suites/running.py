"""Runs the cases of a suite through the batch's processes, and judges them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError
from analysis.files import read_json
from analysis.protocols.table import Row, write
from analysis.protocols.verdict import Verdict
from cosim.batches.batch import BatchRequest, Result, prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.batches.study import study_of
from cosim.suites.judging import Case, judge, settled

RUN_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True)
class Finished:
    """A suite that was run."""

    rows: Sequence[Row]
    result: Result

    @property
    def exit_code(self) -> int:
        """3 if a run is missing or not valid, else 1 if a preventable case was failed, else 0."""
        if not self.result.good or any(row.verdict is None for row in self.rows):
            return 3
        return int(any(row.verdict.counts for row in self.rows if row.verdict is not None))


def run_cases(
    cases: Sequence[Case], controllers: Sequence[str], out: Path, jobs: int | None = None, seed: int = 1
) -> Finished:
    """Run cases with controllers into the folder of a study, and write ``protocol.csv`` there.

    Raises
    ------
    InputError
        For an unknown controller, and a folder that holds something else; nothing is simulated then.
    """
    content = {
        "scenarios": [case.reference for case in cases],
        "controllers": list(controllers),
        "seeds": [seed],
        "run_timeout_s": RUN_TIMEOUT_S,
    }
    name = f"suite:{cases[0].suite}"
    request = BatchRequest(Path(f"{cases[0].suite}.toml"), out, jobs, table=study_of(content, name))
    with prepared(request, shown_checks()) as batch:
        result = batch.run(shown_tally())
        folders = {
            (job.configuration.scenario, job.configuration.controller): batch.ledger.run_folder(job.name)
            for job in batch.jobs
        }
    rows: list[Row] = []
    for controller in controllers:
        rows += _judged(cases, controller, seed, folders)
    write(out, rows)
    return Finished(rows, result)


def _judged(
    cases: Sequence[Case], controller: str, seed: int, folders: dict[tuple[str, str], Path]
) -> list[Row]:
    verdicts: list[tuple[Case, Verdict]] = []
    missing: dict[str, str] = {}
    for case in cases:
        folder = folders[case.reference, controller]
        try:
            described = _description(folder)
            if not described.get("valid"):
                missing[case.name] = str(described.get("invalid_reason") or "there is no run")
                continue
            verdicts.append((case, judge(folder, case)))
        except AnalysisError as error:
            missing[case.name] = str(error)
    found = {case.name: verdict for case, verdict in settled(verdicts)}
    return [
        Row(
            *(case.suite, case.name, case.group.name, controller, seed, case.ego_speed_kmh),
            *(case.group.description, case.group.share, found.get(case.name), missing.get(case.name, "")),
        )
        for case in cases
    ]


def _description(folder: Path) -> dict[str, Any]:
    try:
        return read_json(folder / "run.json")
    except FileNotFoundError:
        return {}
