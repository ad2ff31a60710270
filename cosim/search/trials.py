"""Makes the runs of trials as a batch does, with worker processes, time-outs and resuming."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from analysis.criteria.criterion import Criterion
from analysis.files import read_csv
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.search.axes import Point
from analysis.search.objective import Verdict, judge_run
from cosim.batches.conduct import Crew, Tally, conduct
from cosim.batches.identity import Identity, identity_of
from cosim.batches.job import Configuration, Job
from cosim.batches.ledger import Ledger
from cosim.batches.pool import Pool
from cosim.batches.worker import Handling
from cosim.errors import InputError
from cosim.recording.provenance import Inputs
from cosim.search.scenario_file import scenario_text
from cosim.search.subject import Subject
from sumo_scenarios import library

SCENARIOS = "scenarios"
"""Folder of the scenario files of trials, inside that of the runs."""


@dataclass(frozen=True, slots=True)
class Where:
    """Where runs are made."""

    processes: int
    """Number of runs made at the same time on this machine."""
    scheduler: str | None = None
    """Address of a Dask scheduler, whose workers make the runs instead."""


@dataclass(frozen=True, slots=True)
class Makers:
    """Processes for the runs of trials."""

    pool: Pool
    """Processes on this machine, which determine the inputs of a run."""
    crew: Crew
    """Processes that make the runs."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A point, and the seed with which it is run."""

    name: str
    """Name of its scenario."""
    point: Point
    seed: int
    description: str


@dataclass(frozen=True, slots=True)
class Answer:
    """Outcome of a trial."""

    trial: Trial
    verdict: Verdict
    invalid: str = ""
    """Why there is no valid run; empty if there is one."""


class Trials:
    """Makes the runs of trials in a folder; `running` opens it.

    Parameters
    ----------
    subject
    folder
        Folder of the scenarios and runs.
    makers
    ledger, tally, show
        As for a batch.
    """

    def __init__(
        self,
        subject: Subject,
        folder: Path,
        makers: Makers,
        ledger: Ledger,
        tally: Tally,
        show: Callable[[Tally], None],
    ) -> None:
        self._subject = subject
        self.folder = folder
        self._makers = makers
        self._ledger = ledger
        self.tally = tally
        self._show = show
        self._started = False

    def run(self, trials: Sequence[Trial]) -> list[Answer]:
        """Make the missing runs, and return the answers of all trials in their order.

        Raises
        ------
        InputError
            If a trial cannot be run, or a run was made by another search, code or version.
        SimulationError
            If the disk is full, or no process can be kept alive.
        """
        finished = set(self._ledger.finished())
        jobs = [self._job(trial, finished) for trial in trials]
        identities = self._identities(jobs)
        done = [job for job in jobs if job.name in finished]
        self._ledger.check_unchanged(done, identities.__getitem__)
        for name in sorted(self._ledger.damaged):
            raise InputError(f"{name}: {self._ledger.damaged[name]}")
        self.tally.done += len(done)
        missing = [job for job in jobs if job.name not in finished]
        conduct(missing, self._makers.crew, self._ledger, identities.__getitem__, self.tally, self._show)
        failures = {str(one["run"]): str(one["reason"]) for one in self._ledger.failures()}
        kept = set(self._ledger.finished())
        return [self._answer(trial, job, kept, failures) for trial, job in zip(trials, jobs, strict=True)]

    def encounters(self, trial: Trial) -> list[dict[str, str]]:
        """Return the rows of encounters.csv of a finished trial."""
        return read_csv(self.run_folder(trial) / ENCOUNTERS.file)

    def run_folder(self, trial: Trial) -> Path:
        """Return the folder of the run of a trial."""
        return self._ledger.run_folder(self._configured(trial).name)

    def _configured(self, trial: Trial) -> Job:
        place = self.folder / SCENARIOS / trial.name
        configuration = Configuration(
            scenario=f"{SCENARIOS}/{trial.name}",
            place=str(place.resolve()),
            scenario_name=trial.name,
            controller=self._subject.controller,
            scenario_settings=(),
            controller_settings=self._subject.controller_settings,
            varied=(),
        )
        return Job(configuration, trial.seed)

    def _job(self, trial: Trial, finished: set[str]) -> Job:
        """Write the scenario of a trial, and return its run."""
        job = self._configured(trial)
        folder = self.folder / SCENARIOS / trial.name
        file = folder / library.DEFINITION
        text = scenario_text(self._subject, trial.point, folder, trial.description)
        if file.is_file() and file.read_text(encoding="utf-8") != text and job.name in finished:
            raise InputError(
                f"{self.folder}: {trial.name} would be another one now: the code of the search, or a package "
                "that proposes trials, has changed; expected the versions that it began with, or a new --out"
            )
        folder.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8", newline="\n")
        return job

    def _identities(self, jobs: Sequence[Job]) -> dict[Job, Identity]:
        """Return the inputs of each run; SUMO reads the scenario of the very first run, too."""
        futures = []
        for job in jobs:
            futures.append(self._makers.pool.check(job, not self._started))
            self._started = True
        found: dict[Job, Identity] = {}
        for job, future in zip(jobs, futures, strict=True):
            answer: tuple[Inputs, str] | str = future.result()
            if isinstance(answer, str):
                raise InputError(f"{job.configuration.scenario_name}: {answer}")
            found[job] = identity_of(answer[0], answer[1])
        return found

    def _answer(self, trial: Trial, job: Job, kept: set[str], failures: Mapping[str, str]) -> Answer:
        if job.name not in kept:
            return Answer(trial, Verdict(None), failures.get(job.name, "failed") or "failed")
        description = self._ledger.description(job.name)
        if not description["valid"]:
            return Answer(trial, Verdict(None), str(description["invalid_reason"]))
        return Answer(trial, judged(self._subject.criteria, self._ledger.run_folder(job.name)))


def judged(criteria: Sequence[Criterion], run: Path) -> Verdict:
    """Return the verdict on a finished run."""
    return judge_run(criteria, read_csv(run / ENCOUNTERS.file), read_csv(run / RUNS.file))


@contextmanager
def makers(subject: Subject, folder: Path, where: Where, handling: Handling) -> Iterator[Makers]:
    """Yield the processes that make runs; nothing is written.

    Parameters
    ----------
    subject
    folder
        Folder of the trials.
    where
    handling

    Raises
    ------
    InputError
        If no scheduler answers at the address, or a worker there has another version of anything.
    """
    with Pool(where.processes, handling) as pool:
        if where.scheduler is None:
            yield Makers(pool, pool)
            return
        from cosim.batches.dask_cluster import Cluster
        from cosim.batches.shipping import common

        values = tuple(subject.values.items())
        base = Configuration(
            subject.scenario, subject.place, subject.loaded.name, subject.controller, values, (), ()
        )
        shared = common(folder / SCENARIOS, [base])
        with Cluster(where.scheduler, folder, [base], handling, shared) as cluster:
            yield Makers(pool, cluster)


@contextmanager
def running(
    subject: Subject,
    folder: Path,
    about: str,
    hands: Makers,
    total: int,
    show: Callable[[Tally], None],
) -> Iterator[Trials]:
    """Open the folder of trials.

    Parameters
    ----------
    subject
    folder
        A new folder, or that of the same search.
    about
        Text on the search to which the trials belong; it is kept beside them.
    hands
        Processes that `makers` yields.
    total
        Number of planned runs, for showing the progress.
    show
    """
    ledger = Ledger(folder)
    with ledger.opened(Path(folder.name), about):
        ledger.find_damage()
        (folder / SCENARIOS).mkdir(exist_ok=True)
        try:
            yield Trials(subject, folder, hands, ledger, Tally(total), show)
        finally:
            hands.pool.close()  # before the files of unfinished runs are removed


def copy_scenario(subject: Subject, trial: Trial, folder: Path) -> None:
    """Write the scenario of a trial to another folder, from which it can be run just as well."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    text = scenario_text(subject, trial.point, folder, trial.description)
    (folder / library.DEFINITION).write_text(text, encoding="utf-8", newline="\n")
