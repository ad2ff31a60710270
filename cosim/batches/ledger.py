"""The folder of a study: which runs are finished, which failed, and whether it is still the same study.

A finished run is moved to ``runs/`` by a single renaming. A batch can therefore be interrupted at any
moment and loses only the runs in progress.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from analysis.files import PART, write_csv, write_json, write_text
from analysis.study.runs import STUDY_FILE
from cosim.batches.identity import Identity, differences
from cosim.batches.job import Job
from cosim.batches.lock import take
from cosim.batches.outcome import RUN, Outcome
from cosim.batches.stored import DAMAGED, FAILURE, read_failure, read_made, run_damages
from cosim.errors import InputError
from cosim.recording import folders

RUNS = "runs"
FAILED = "failed"
WORK = ".work"
"""Folder of runs in progress, emptied when a batch begins and ends; searches for runs skip hidden folders."""
LOCK = ".lock"
FAILURES = "failed.csv"

_COLUMNS = ("run", "scenario", "controller", "seed", "attempts", "reason", "command")


class Ledger:
    """Reads and updates the folder of a study.

    Parameters
    ----------
    folder : Path
        Need not exist; nothing is written before `opened`.

    Raises
    ------
    InputError
        If the folder holds anything other than a study.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.damaged: dict[str, str] = {}
        """Which file of a finished run was altered or lost, and the remedy, by name of the run."""
        folders.check_links(folder)
        try:
            if folder.is_dir():
                foreign = any(path.name not in (LOCK, STUDY_FILE + PART) for path in folder.iterdir())
                if foreign and not _is_study(folder):
                    raise InputError(
                        f"--out {folder}: expected an empty or new folder, or the one of this study; "
                        "this one has other files in it"
                    )
            elif folder.exists():
                raise InputError(f"--out {folder}: expected a folder, this is a file")
        except OSError as error:
            raise InputError(f"--out {folder}: {error.strerror}") from error

    @contextmanager
    def opened(self, study_file: Path, text: str | None = None) -> Iterator[None]:
        """Lock the folder against other batches within the context.

        Parameters
        ----------
        study_file : Path
        text : str
            Content of the study, if it differs from that of the file.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            lock = (self.folder / LOCK).open("a")
        except OSError as error:
            raise InputError(f"--out {self.folder}: {error.strerror}") from error
        with lock:
            try:
                take(lock)
            except BlockingIOError as error:
                raise InputError(f"--out {self.folder}: another batch is at work in this folder") from error
            try:
                write_text(self.folder / STUDY_FILE, study_file.read_text("utf-8") if text is None else text)
                for name in (RUNS, FAILED):
                    (self.folder / name).mkdir(exist_ok=True)
                self._clear()
            except OSError as error:
                raise InputError(f"--out {self.folder}: {error.strerror}") from error
            try:
                yield
            finally:
                self._clear()

    def finished(self) -> list[str]:
        """Return the names of the finished runs, sorted."""
        folder = self.folder / RUNS
        if not folder.is_dir():
            return []
        return sorted(path.name for path in folder.iterdir() if path.is_dir())

    def name_of(self, folder: Path) -> str:
        """Return the name of the run to which one of the `recorded` folders belongs."""
        return folder.name if folder.parent.name == RUNS else folder.parent.name

    def run_folder(self, name: str) -> Path:
        """Return the folder of a finished run."""
        return self.folder / RUNS / name

    def whole(self) -> list[str]:
        """Return the names of the finished runs that are not known to be damaged, sorted."""
        return [name for name in self.finished() if name not in self.damaged]

    def recorded(self) -> list[Path]:
        """Return the folders of undamaged finished runs, and those that failed runs have left."""
        failed = (path.parent for path in (self.folder / FAILED).glob(f"*/{RUN}/run.json"))
        return [*(self.run_folder(name) for name in self.whole()), *sorted(failed)]

    def work_folder(self, job: Job, attempt: int) -> Path:
        """Return the folder in which an attempt at a run is made."""
        return self.folder / WORK / f"{job.name}-{attempt}"

    def missing(self, jobs: Sequence[Job]) -> list[Job]:
        """Return the runs that are not finished.

        Raises
        ------
        InputError
            If a finished run does not belong to the study.
        """
        finished = set(self.finished())
        missing = []
        for job in jobs:
            if job.name in finished:
                finished.discard(job.name)
            else:
                missing.append(job)
        if finished:
            raise InputError(
                f"--out {self.folder} belongs to another study: {len(finished)} finished runs in it are not "
                f"in this one, for instance {min(finished)}; expected a new folder, or the study that made it"
            )
        return missing

    def verify(self, jobs: Sequence[Job], identity: Callable[[Job], Identity]) -> None:
        """Check that the finished runs among ``jobs`` are undamaged and were made from the present inputs.

        Runs whose files were altered or lost are entered in `damaged`.

        Parameters
        ----------
        jobs : Sequence
        identity : Callable
            Returns the identity that a run would have now.

        Raises
        ------
        InputError
            If runs were made from other inputs; names the first one, and what differs.
        """
        self.find_damage()
        self.check_unchanged(jobs, identity)

    def check_unchanged(self, jobs: Sequence[Job], identity: Callable[[Job], Identity]) -> None:
        """Check that the undamaged runs were made from the present inputs; raises as `verify` does."""
        whole = set(self.whole())
        stale: list[tuple[str, list[str]]] = []
        for job in jobs:
            if job.name in whole and (told := self._changes(job.name, identity(job))):
                stale.append((job.name, told))
        if stale:
            name, told = stale[0]
            others = f" (and {len(stale) - 1} further runs)" if len(stale) > 1 else ""
            raise InputError(
                f"{self.folder}: the run {name}{others} was made from other inputs: {_short(told)}; "
                "expected the same inputs, or a new folder"
            )

    def keep(self, outcome: Outcome, identity: Identity) -> str:
        """Move a run just made to its place; return the reason, in one line, if it cannot be kept.

        Raises
        ------
        OSError
            If the files cannot be moved.
        """
        made = outcome.folder / RUN
        description, source = read_made(made)
        told = differences(identity, description, source)
        if told:
            return f"the inputs changed while the batch was running: {_short(told)}"
        target = self.run_folder(outcome.job.name)
        made.replace(target)
        shutil.rmtree(outcome.folder, ignore_errors=True)
        shutil.rmtree(self.folder / FAILED / target.name, ignore_errors=True)
        return ""

    def keep_failure(self, outcome: Outcome, attempts: int) -> None:
        """Keep what a failed run left, with the reason and the last lines of its log.

        Raises
        ------
        OSError
            If the files cannot be written.
        """
        job, one = outcome.job, outcome.job.configuration
        target = self.folder / FAILED / job.name
        shutil.rmtree(target, ignore_errors=True)
        if outcome.folder.is_dir():
            outcome.folder.replace(target)
        else:
            target.mkdir()
        content = {
            "run": job.name,
            "scenario": one.scenario_name,
            "place": one.place,
            "controller": one.controller,
            "varied": dict(one.varied),
            "seed": job.seed,
            "attempts": attempts,
            "reason": outcome.reason,
            "command": job.command(),
            "last_lines": list(Outcome(job, target).last_lines()),
        }
        write_json(target / FAILURE, content)

    def failures(self) -> list[dict[str, Any]]:
        """Return the failed runs, sorted by name; if the file of one is damaged, that is its reason."""
        paths = sorted((self.folder / FAILED).glob("*"))
        return [read_failure(path) for path in paths if path.is_dir()]

    def write_failures(self) -> dict[str, str]:
        """Write ``failed.csv``, one row for each failed run; return the result of `damaged_failures`."""
        rows = [[one.get(column, "") for column in _COLUMNS] for one in self.failures()]
        write_csv(self.folder / FAILURES, _COLUMNS, rows)
        return self.damaged_failures()

    def damaged_failures(self) -> dict[str, str]:
        """Return what is wrong with failed runs whose files cannot be read, by name of the run."""
        return {one["run"]: one["reason"] for one in self.failures() if one.get(DAMAGED)}

    def description(self, name: str) -> dict[str, Any]:
        """Return the content of a finished run's ``run.json``."""
        return read_made(self.run_folder(name))[0]

    def find_damage(self) -> None:
        """Check the files of every finished run, and enter what is wrong with them in `damaged`."""
        for name in self.finished():
            if told := run_damages(self.run_folder(name)):
                self.damaged[name] = _first(told)

    def _changes(self, name: str, identity: Identity) -> list[str]:
        return differences(identity, *read_made(self.run_folder(name)))

    def _clear(self) -> None:
        shutil.rmtree(self.folder / WORK, ignore_errors=True)


def _is_study(folder: Path) -> bool:
    """Return whether a folder is that of a study, even if the copy of the study file was lost."""
    return (folder / STUDY_FILE).is_file() or ((folder / LOCK).is_file() and (folder / RUNS).is_dir())


def _first(told: Sequence[str]) -> str:
    return told[0] + (f" (and {len(told) - 1} further files)" if len(told) > 1 else "")


def _short(told: Sequence[str]) -> str:
    most = 3
    further = f" and {len(told) - most} further differences" if len(told) > most else ""
    return "; ".join(told[:most]) + further
