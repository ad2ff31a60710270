"""The loop of a batch: a run is tried once more, one whose process was lost again and again, but not for ever."""

from __future__ import annotations

import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from cosim.batches.conduct import ATTEMPTS, LOSSES_IN_A_ROW, Tally, conduct
from cosim.batches.identity import Identity
from cosim.batches.job import Job
from cosim.batches.ledger import Ledger
from cosim.batches.outcome import Outcome
from cosim.batches.pool import Pool
from cosim.batches.worker import Handling
from cosim.errors import SimulationError
from tests.cosim.batches.studies import some_job, write_study

JOB = some_job()
LOST, BROKEN = "the process was gone before the run began", "it broke"


class Crew:
    """Makes no run: each of its attempts ends with the reason that it is told, by the number of the attempt."""

    processes = 1

    def __init__(self, reason: Callable[[int], str]) -> None:
        """Begin with the first attempt."""
        self.attempts = 0
        self._reason = reason

    def capacity(self) -> int:
        return self.processes

    def submit(self, job: Job, folder: Path) -> Future[Outcome]:
        self.attempts += 1
        reason = self._reason(self.attempts)
        over: Future[Outcome] = Future()
        over.set_result(Outcome(job, folder, reason, lost=reason == LOST))
        return over


@pytest.fixture
def ledger(tmp_path: Path) -> Iterator[Ledger]:
    one = Ledger(tmp_path / "out")
    with one.opened(write_study(tmp_path)):
        yield one


def made(crew: Crew, ledger: Ledger) -> Tally:
    tally = Tally(total=1)
    conduct([JOB], crew, ledger, _nobody_asks, tally, lambda _: None)
    return tally


def _nobody_asks(job: Job) -> Identity:
    raise AssertionError(job)


def test_a_run_that_fails_is_tried_once_more_and_kept_as_failed(ledger: Ledger) -> None:
    crew = Crew(lambda _: BROKEN)
    tally = made(crew, ledger)
    assert (crew.attempts, tally.done, tally.failed, tally.running) == (ATTEMPTS, 0, 1, 0)
    (failure,) = ledger.failures()
    assert (failure["run"], failure["reason"], failure["attempts"]) == (JOB.name, BROKEN, 2)


def test_a_batch_that_keeps_no_process_alive_ends_and_blames_no_run(ledger: Ledger) -> None:
    crew = Crew(lambda _: LOST)
    with pytest.raises(SimulationError, match=f"no worker process stays alive: {LOST}"):
        made(crew, ledger)
    assert crew.attempts == LOSSES_IN_A_ROW + 1
    assert ledger.failures() == []


def test_lost_processes_are_no_attempts_of_a_run_and_count_anew_after_each_that_began(ledger: Ledger) -> None:
    began = LOSSES_IN_A_ROW + 1
    crew = Crew(lambda attempt: LOST if attempt % began else BROKEN)
    tally = made(crew, ledger)
    assert (crew.attempts, tally.failed) == (ATTEMPTS * began, 1)
    assert ledger.failures()[0]["attempts"] == ATTEMPTS


def test_a_full_disk_ends_the_batch_at_once(ledger: Ledger) -> None:
    crew = Crew(lambda _: "No space left on device")
    with pytest.raises(SimulationError, match="no room for files"):
        made(crew, ledger)
    assert crew.attempts == 1
    assert ledger.failures() == []


@pytest.mark.long
@pytest.mark.parametrize("module", ["queue.py", "_base.py"])
def test_an_interrupt_never_ends_code_that_holds_a_lock_of_the_processes(ledger: Ledger, module: str) -> None:
    """A queue left in the middle of a ``put`` let a thread of the pool sleep for ever, and the batch with it."""
    with Pool(1, Handling(60.0)) as pool:
        pool.check(JOB, start_sumo=False).result()  # the pool has started
        sys.settrace(_interrupted_in(module))
        try:
            with pytest.raises(KeyboardInterrupt) as caught:
                conduct([JOB], pool, ledger, _nobody_asks, Tally(total=1), lambda _: None)
        finally:
            sys.settrace(None)
    places = [Path(frame.filename).name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert "conduct.py" in places
    assert module not in places


def _interrupted_in(module: str) -> Any:
    """Return a tracer that sends Ctrl-C as soon as this process executes code of the module."""
    sent = False

    def trace(frame: FrameType, event: str, argument: object) -> Any:
        nonlocal sent
        if not sent and Path(frame.f_code.co_filename).name == module:
            sent = True
            signal.raise_signal(signal.SIGINT)
        return trace

    return trace
