"""How worker processes start: as copies of a process that has loaded all modules, so that they load once.

Loading the modules that a run needs takes more than a second, and a batch starts many processes: one for each
run at the same time, and a replacement for each process whose run has failed.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Pipe
from multiprocessing.context import BaseContext
from types import ModuleType

LOADED = ("cosim.running.execution", "libsumo", "pandas", "scipy.spatial", "controllers.strategies.vo_mpc")
"""Modules that runs need. Pyarrow loads pandas as soon as it makes an array, SciPy loads its parts on first
use, and other controllers use most of the modules of the default controller."""

_starting = threading.Lock()
_BEGIN_WITHIN_S = 30.0


@contextmanager
def _main_left_alone() -> Iterator[None]:
    """Start processes without executing the user's program again, since they need nothing from it."""
    with _starting:
        program = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = program


if sys.platform != "win32":
    from multiprocessing import forkserver
    from multiprocessing.context import ForkServerContext, ForkServerProcess

    class _BegunProcess(ForkServerProcess):
        """A process whose ``start`` returns only when the process has read its task.

        Until then the process needs locks that its pool may already remove when the pool is stopped.
        """

        def start(self) -> None:
            heard, self._silence = Pipe(duplex=False)
            with heard:
                with self._silence, _main_left_alone():
                    super().start()
                # No data is ever sent: the process closes its end when it begins to run, or when it ends.
                heard.poll(_BEGIN_WITHIN_S)

        def run(self) -> None:
            self._silence.close()
            super().run()

    class _Context(ForkServerContext):
        Process = _BegunProcess


def context() -> BaseContext:
    """Return the context in which to start processes; call this shortly before the start."""
    # New interpreters look for modules in the current folder first: a user's file named like one of the
    # standard library would be executed.
    if sys.platform == "win32" or sys.platform == "darwin":
        os.environ.setdefault("PYTHONSAFEPATH", "1")  # each process is a new interpreter
        return get_context("spawn")  # system libraries of macOS do not survive a fork
    else:
        found = _Context()
        found.set_forkserver_preload([*LOADED])
        path = os.pathsep.join(place or os.getcwd() for place in sys.path)
        # The processes can import whatever this program can, even if it has changed ``sys.path``.
        with _starting, _variables(PYTHONSAFEPATH="1", PYTHONPATH=path):
            forkserver.ensure_running()
        return found


def cores() -> int:
    """Return the number of cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def uninterrupted() -> Iterator[list[int]]:
    """Hold back Ctrl-C and SIGTERM until the end of this block; processes started meanwhile are not affected.

    An interrupt inside a lock, a queue or a future leaves it locked, or a thread that waits for it asleep for
    ever. Blocking the signals is not enough: a thread of a library may take them.

    Yields the signals held back so far; those that the block removes from the list are never delivered.
    """
    held: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield held  # signals come to the main thread only
        return
    before = {
        number: signal.signal(number, lambda came, frame: held.append(came))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield held
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if held:
            signal.raise_signal(held[0])


@contextmanager
def _variables(**values: str) -> Iterator[None]:
    """Set environment variables for new processes, and restore this process's afterwards."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
