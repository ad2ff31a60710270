"""The main loop of a batch: hand out runs, keep those that succeed, and try failed ones once more."""

from __future__ import annotations

import shutil
from collections import Counter, deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Protocol

from cosim.batches.identity import Identity
from cosim.batches.job import Job
from cosim.batches.ledger import Ledger
from cosim.batches.outcome import Outcome, says_full
from cosim.errors import CosimError, SimulationError
from cosim.processes import uninterrupted

ATTEMPTS = 2
LOSSES_IN_A_ROW = 20
"""A batch stops after more lost runs in a row than this, as no process seems to stay alive."""
LOOK_EVERY_S = 0.5
"""Time between two updates while no run ends [s]."""


class Crew(Protocol):
    """Processes that make runs, here or elsewhere."""

    @property
    def processes(self) -> int:
        """Number of runs made at the same time."""
        ...

    def capacity(self) -> int:
        """Return how many runs to hand out at a time; this is called repeatedly.

        Raises
        ------
        SimulationError
            If the processes can no longer be reached.
        """
        ...

    def submit(self, job: Job, folder: Path) -> Future[Outcome]:
        """Make a run in ``folder``, which must not exist."""
        ...


@dataclass(slots=True)
class Tally:
    """Progress of a batch."""

    total: int
    done: int = 0
    failed: int = 0
    running: int = 0
    made: int = 0
    """How many of the runs in ``done`` this batch has made."""
    failures: list[Outcome] = field(default_factory=list)
    """Runs that have just failed for good; the function that shows them removes them."""


def conduct(
    jobs: Sequence[Job],
    crew: Crew,
    ledger: Ledger,
    identity: Callable[[Job], Identity],
    tally: Tally,
    show: Callable[[Tally], None],
) -> None:
    """Make every run; one that fails is tried once more and does not affect the others.

    Parameters
    ----------
    jobs : Sequence
        Runs to make.
    crew : Crew
    ledger : Ledger
        Ledger of an opened folder.
    identity : Callable
        Returns the inputs that a run is to be made from.
    tally : Tally
        Updated while the runs are made.
    show : Callable
        Called whenever something has changed, and from time to time.

    Raises
    ------
    SimulationError
        If the disk is full, or no process can be kept alive; finished runs are kept.
    """
    waiting = deque(jobs)
    attempts: Counter[str] = Counter()
    submissions = 0
    running: set[Future[Outcome]] = set()
    over: SimpleQueue[Future[Outcome]] = SimpleQueue()
    losses = 0
    while waiting or running:
        with uninterrupted():
            capacity = crew.capacity()
            while waiting and len(running) < capacity:
                job = waiting.popleft()
                submissions += 1
                future = crew.submit(job, ledger.work_folder(job, submissions))
                running.add(future)
                future.add_done_callback(over.put)
        tally.running = min(len(running), crew.processes)
        show(tally)
        try:
            future = over.get(timeout=LOOK_EVERY_S)
        except Empty:
            continue
        running.remove(future)
        outcome = _kept(future.result(), ledger, identity)
        losses = losses + 1 if outcome.lost else 0
        if losses > LOSSES_IN_A_ROW:
            raise SimulationError(f"no worker process stays alive: {outcome.reason}")
        if not outcome.reason:
            tally.done += 1
            tally.made += 1
            continue
        if outcome.disk_full:
            raise SimulationError(f"no room for files: {outcome.reason} ({outcome.job.name})")
        attempts[outcome.job.name] += not outcome.lost
        if attempts[outcome.job.name] < ATTEMPTS:
            shutil.rmtree(outcome.folder, ignore_errors=True)
            waiting.append(outcome.job)
            continue
        _keep_failure(outcome, ledger, attempts[outcome.job.name])
        tally.failed += 1
        tally.failures.append(outcome)
    tally.running = 0
    show(tally)


def _kept(outcome: Outcome, ledger: Ledger, identity: Callable[[Job], Identity]) -> Outcome:
    """Put the run in its place, if there is one, and return the resulting outcome."""
    if outcome.reason:
        return outcome
    try:
        reason = ledger.keep(outcome, identity(outcome.job))
    except OSError as error:
        reason = f"{outcome.folder} could not be kept: {error.strerror or error}"
    except CosimError as error:
        reason = str(error)
    return Outcome(outcome.job, outcome.folder, reason)


def _keep_failure(outcome: Outcome, ledger: Ledger, attempts: int) -> None:
    try:
        ledger.keep_failure(outcome, attempts)
    except OSError as error:
        text = error.strerror or str(error)
        what = "no room for files" if says_full(text) else "the study's folder cannot be written to"
        raise SimulationError(f"{what}: {text}") from error
