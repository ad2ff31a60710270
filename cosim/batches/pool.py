"""Worker processes on this machine: long-lived, one run at a time, replaced when they end."""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, cast

from pebble import ProcessExpired, ProcessPool

from cosim import processes
from cosim.batches import worker
from cosim.batches.job import Job
from cosim.batches.outcome import REASON, Outcome
from cosim.batches.worker import Handling
from cosim.recording.provenance import Inputs

RUNS_PER_PROCESS = 100
"""Processes are replaced after this many runs, as SUMO 1.28 leaks about a kilobyte per personFlow."""


class Pool:
    """Processes that make runs; use as a context manager. The future of a run gets a result even if it fails.

    Parameters
    ----------
    processes : int
    handling : Handling
    runs_per_process : int
        After this many runs, a new process replaces the old one.
    """

    def __init__(
        self,
        processes: int,
        handling: Handling,
        runs_per_process: int = RUNS_PER_PROCESS,
    ) -> None:
        self._processes = processes
        self._runs_per_process = runs_per_process
        self._handling = handling
        self._pool: Any = None

    def __enter__(self) -> Pool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def processes(self) -> int:
        """Number of runs made at the same time."""
        return self._processes

    def capacity(self) -> int:
        """Return how many runs to hand out at a time: one waits for each process, so that none is idle."""
        return 2 * self._processes

    def submit(self, job: Job, folder: Path, place: str | None = None) -> Future[Outcome]:
        """Make a run in ``folder``, which must not exist.

        Parameters
        ----------
        job : Job
        folder : Path
        place : str
            Where the scenario is on this machine; ``None`` for the place that the job names.
        """

        def outcome(done: Future[None]) -> Outcome:
            return _outcome(done, job, folder, self._handling.timeout_s)

        arguments = (job, place or job.configuration.place, folder, self._handling)
        return self._schedule(worker.make, arguments, self._handling.timeout_s, outcome)

    def check(self, job: Job, start_sumo: bool) -> Future[tuple[Inputs, str] | str]:
        """Return the inputs of a run and the hash of the code, or why it cannot be made."""
        limit = self._handling.timeout_s
        return self._schedule(worker.check, (job, start_sumo), limit, partial(_answer, timeout_s=limit))

    def close(self) -> None:
        """End the processes, including the runs that they are making."""
        with processes.uninterrupted():
            if self._pool is not None:
                self._pool.stop()
                self._pool.join()
                self._pool = None

    def _schedule(
        self, function: Callable[..., Any], arguments: tuple[Any, ...], timeout_s: float, read: Any
    ) -> Future[Any]:
        result: Future[Any] = Future()
        # If this process ended now, a child that is just starting would outlive it and print an error.
        with processes.uninterrupted():
            inner = self._running().schedule(function, args=arguments, timeout=timeout_s)
            inner.add_done_callback(lambda done: result.set_result(read(done)))
        return result

    def _running(self) -> Any:
        """Return the pool; start it first if it is new or all its processes died at once."""
        # Set before the processes load NumPy: two of them with several BLAS threads each are slower than one.
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
            os.environ.setdefault(name, "1")
        with ExitStack() as end:
            # Ctrl-C goes to every process of a terminal, but only this one may act on it. The threads of the
            # pool inherit the signals blocked here, and so do the processes that they start.
            if sys.platform != "win32":
                before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
                end.callback(signal.pthread_sigmask, signal.SIG_SETMASK, before)
            if self._pool is not None and not self._pool.active:
                self.close()
            if self._pool is None:
                self._pool = ProcessPool(
                    self._processes,
                    max_tasks=self._runs_per_process,
                    initializer=worker.begin,
                    initargs=(dict(os.environ),),
                    context=cast(Any, processes.context()),
                )
                assert self._pool.active  # started here and now, with the signal blocked
            return self._pool


def _outcome(done: Future[None], job: Job, folder: Path, timeout_s: float) -> Outcome:
    lost = False
    try:
        done.result()
        reason = ""
    except TimeoutError:
        reason = f"still running after run_timeout_s = {timeout_s:g} s"
    except ProcessExpired as error:
        reason = _left_behind(folder) or _ending(int(error.exitcode))
    except (BrokenProcessPool, CancelledError):
        reason, lost = "the worker processes were gone before the run began", True
    except Exception as error:  # noqa: BLE001  anything that the pool reports; told as the run's failure
        reason = " ".join(f"{type(error).__name__}: {error}".split())
    return Outcome(job, folder, reason, lost)


def _answer(done: Future[tuple[Inputs, str] | str], timeout_s: float) -> tuple[Inputs, str] | str:
    try:
        return done.result()
    except TimeoutError:
        return (
            f"the controller's first plans and SUMO's start took longer than run_timeout_s = {timeout_s:g} s"
        )
    except ProcessExpired as error:
        return f"it ended at the controller's first plans or at SUMO's start: {_ending(int(error.exitcode))}"
    except Exception as error:  # noqa: BLE001  anything that the pool reports; told as bad input
        return f"{type(error).__name__}: {error}"


def _left_behind(folder: Path) -> str:
    try:
        return (folder / REASON).read_text(encoding="utf-8").strip()
    except OSError:
        return ""


def _ending(code: int) -> str:
    """Return how a process ended, in words.

    Examples
    --------
    >>> _ending(-11)
    'the process ended by SIGSEGV'
    """
    if code == worker.DISK_FULL:
        return os.strerror(errno.ENOSPC)
    if code >= 0:
        return f"the process ended with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    hint = (
        " (who killed it is not known; with little memory left, the system does)" if name == "SIGKILL" else ""
    )
    return f"the process ended by {name}{hint}"
