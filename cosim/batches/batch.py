"""Runs a batch, from its study file to its tables."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from cosim.batches import preflight, tables
from cosim.batches.conduct import Tally, conduct
from cosim.batches.estimate import Estimate, estimate
from cosim.batches.job import Job
from cosim.batches.ledger import Ledger
from cosim.batches.matrix import Matrix, build_matrix
from cosim.batches.pool import Pool
from cosim.batches.preflight import Checked
from cosim.batches.study import StudyTable, read_study, study_text
from cosim.batches.worker import Handling
from cosim.errors import SimulationError
from cosim.presentation.notes import outputs_notes
from cosim.processes import cores
from cosim.recording.folders import DEFAULT_PARENT

if TYPE_CHECKING:
    from cosim.batches.dask_cluster import Cluster

Shown = AbstractContextManager[Callable[[Tally], None]]


@dataclass(frozen=True, slots=True)
class BatchRequest:
    """A user's request for a batch."""

    study: Path
    out: Path | None = None
    """Folder of the study; ``None`` for one below ``runs`` named after the study file."""
    jobs: int | None = None
    """Runs made at the same time; ``None`` for the number of cores that this process may use."""
    scheduler: str | None = None
    """Address of a Dask scheduler, whose workers make the runs."""
    drop_recordings: bool = False
    allow_programs: bool = False
    """Whether the study file may name controllers by an address, whose code is executed."""
    table: StudyTable | None = None
    """Content of the study if it does not come from a file; ``study`` is then its name, and paths of
    scenarios are relative to the folder of ``study``."""
    again: str = ""
    """Command that continues the batch after it has ended; empty for ``cosim batch``."""

    @property
    def folder(self) -> Path:
        """Folder of the study."""
        return DEFAULT_PARENT / self.study.stem if self.out is None else self.out

    @property
    def processes(self) -> int:
        """Worker processes on this machine."""
        return self.jobs or cores()

    def command(self) -> str:
        """Return the command that continues the batch after it has ended."""
        if self.again:
            return self.again
        words = ["cosim", "batch", str(self.study)]
        if self.out is not None:
            words += ["--out", str(self.out)]
        if self.jobs is not None:
            words += ["--jobs", str(self.jobs)]
        if self.scheduler is not None:
            words += ["--scheduler", self.scheduler]
        if self.drop_recordings:
            words.append("--drop-recordings")
        if self.allow_programs:
            words.append("--allow-programs")
        return shlex.join(words)


@dataclass(frozen=True, slots=True)
class Result:
    """Result of a batch."""

    tally: Tally
    stopped: str
    """Why the batch ended early; empty if it did not."""
    not_valid: dict[str, str]
    """Finished runs that are not valid, and why."""
    damaged: dict[str, str]
    """Runs left out of the tables because a file was altered or lost: which file, and the remedy."""
    notes: list[str]
    """Notes on the finished runs, each given once for all of them."""

    @property
    def good(self) -> bool:
        """Whether every run is finished and valid."""
        return not (self.stopped or self.tally.failed or self.not_valid or self.damaged)


@dataclass(frozen=True, slots=True)
class Batch:
    """A study whose configurations have all been checked, ready to be run."""

    request: BatchRequest
    study: StudyTable
    matrix: Matrix
    ledger: Ledger
    checked: Checked
    pool: Pool
    jobs: list[Job] = field(repr=False)
    missing: list[Job] = field(repr=False)

    def estimate(self, processes: int) -> Estimate:
        """Return how long the missing runs take."""
        return estimate(self.jobs, self.missing, self.ledger, self.checked, processes)

    def run(self, shown: Shown) -> Result:
        """Make the missing runs, and write the tables of all finished ones."""
        stopped = ""
        with self._crew() as crew, self.ledger.opened(self.request.study, self._text()):
            missing = self.ledger.missing(self.jobs)  # another batch may have ended just before
            tally = Tally(len(self.jobs), done=self._done(missing))
            tables.get_ready()
            try:
                with shown as show:
                    conduct(missing, crew, self.ledger, self.checked.identity, tally, show)
            except KeyboardInterrupt:
                stopped = "interrupted"
                # The interrupt may have come after a run was put in its place, but before it was counted.
                tally.done = self._done(self.ledger.missing(self.jobs))
            except SimulationError as error:
                stopped = str(error)
            crew.close()  # before the files of unfinished runs are removed
            damaged: dict[str, str] = {}
            try:
                damaged = tables.write(self.ledger, self.study.controllers)
            except SimulationError as error:
                stopped = stopped or str(error)
            finished = self.ledger.finished()
            self.ledger.damaged |= {name: told for name, told in damaged.items() if name in finished}
            tally.done = self._done(self.ledger.missing(self.jobs))
        described = {name: self.ledger.description(name) for name in self.ledger.whole()}
        not_valid = {name: str(one["invalid_reason"]) for name, one in described.items() if not one["valid"]}
        notes = outputs_notes(described.values())
        return Result(tally, stopped, not_valid, damaged | self.ledger.damaged, notes)

    def _done(self, missing: Sequence[Job]) -> int:
        """Return how many runs are finished and undamaged."""
        return len(self.jobs) - len(missing) - len(self.ledger.damaged)

    def _text(self) -> str | None:
        return None if self.request.table is None else study_text(self.request.table)

    def _crew(self) -> Pool | Cluster:
        if self.request.scheduler is None:
            return self.pool
        from cosim.batches.dask_cluster import Cluster

        self.pool.close()
        handling = _handling(self.request, self.study)
        return Cluster(self.request.scheduler, self.ledger.folder, self.matrix.configurations, handling)


@contextmanager
def prepared(
    request: BatchRequest, progress: preflight.Progress = lambda done, total: None
) -> Iterator[Batch]:
    """Check everything that can be wrong, and yield the batch; nothing is written yet.

    Raises
    ------
    InputError
        If a batch cannot be made from the study or in the folder.
    """
    study = request.table or read_study(request.study, request.allow_programs)
    matrix = build_matrix(study, request.study)
    ledger = Ledger(request.folder)
    jobs = matrix.jobs()
    missing = ledger.missing(jobs)
    most = max(len(missing), len({one.road for one in matrix.configurations}))
    with Pool(min(request.processes, most), _handling(request, study)) as pool:
        checked = preflight.check(matrix, pool, request.study, progress)
        ledger.verify(jobs, checked.identity)
        yield Batch(request, study, matrix, ledger, checked, pool, jobs, missing)


def _handling(request: BatchRequest, study: StudyTable) -> Handling:
    return Handling(study.run_timeout_s, request.drop_recordings)
