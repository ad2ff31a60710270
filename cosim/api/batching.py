"""``cosim.batch``: scenarios × controllers × seeds × varied parameters, on many processes."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from os import PathLike
from pathlib import Path
from typing import Any

from cosim.api.study import Study
from cosim.batches.batch import BatchRequest, Result, Shown, prepared
from cosim.batches.ledger import FAILURES
from cosim.batches.study import study_of


def batch(
    study: str | PathLike[str] | Mapping[str, Any],
    *,
    out: str | PathLike[str] | None = None,
    jobs: int | None = None,
    drop_recordings: bool = False,
    allow_programs: bool = False,
) -> Study:
    """Run a study, and return its folder with the tables; a repeated call makes the missing runs.

    Parameters
    ----------
    study
        A study file, or its content: ``{"scenarios": ["midblock_zebra"], "controllers": ["sumo", "vo_mpc"],
        "seeds": "1-30", "set": {"duration_s": 300}}``. Controllers are given by name or address, not as
        objects, because the runs are made in other processes.
    out
        Folder of the study; one with results of the same study is completed. By default ``runs/<study>``.
    jobs
        Number of runs made at the same time; by default one per core.
    drop_recordings
        Whether to keep only the numbers of each run.
    allow_programs
        Whether a study file may name controllers by an address (``./patient.py``), whose code is executed;
        a dictionary of your program always may.

    Raises
    ------
    InputError
        If anything is found wrong before the first run.
    """
    table = study_of(study, "study") if isinstance(study, Mapping) else None
    name = Path("study") if isinstance(study, Mapping) else Path(study)
    where = None if out is None else Path(out)
    again = "the same call of cosim.batch" if table is not None else ""
    request = BatchRequest(name, where, jobs, None, drop_recordings, allow_programs, table, again)
    with prepared(request) as one:
        shown: Shown = nullcontext(lambda tally: None)
        return Study(one.ledger.folder, _problems(one.run(shown)))


def _problems(result: Result) -> tuple[str, ...]:
    found = [result.stopped] if result.stopped else []
    if result.tally.failed:
        found.append(f"{result.tally.failed} of {result.tally.total} runs failed; {FAILURES} says why")
    found += [f"{name} is invalid: {reason}" for name, reason in result.not_valid.items()]
    found += [f"{name} is damaged: {told}" for name, told in result.damaged.items()]
    return tuple(found)
