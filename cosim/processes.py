"""How worker processes start: as copies of one that has loaded everything, so that it is loaded once.

To load what a run needs takes more than a second, and a batch starts many processes: one for each run at a
time, and another one in the place of each whose run has failed.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Pipe
from multiprocessing.context import BaseContext
from types import ModuleType

LOADED = ("cosim.running.execution", "libsumo", "pandas", "scipy.spatial", "controllers.strategies.vo_mpc")
"""What runs need. Pandas is what pyarrow loads as soon as it makes an array, SciPy loads its parts when they
are used, and on most of what the default controller stands on others stand, too."""

_starting = threading.Lock()
_BEGIN_WITHIN_S = 30.0


@contextmanager
def _main_left_alone() -> Iterator[None]:
    """Start processes that do not execute the user's program again: they need nothing of it."""
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
        """A process of which ``start`` returns when it has read what it is to do.

        Until then it needs locks that the pool which started it may already take away, when it is stopped.
        """

        def start(self) -> None:
            heard, self._silence = Pipe(duplex=False)
            with heard:
                with self._silence, _main_left_alone():
                    super().start()
                # Nothing is ever said: the process closes its end as it begins, or by its own end.
                heard.poll(_BEGIN_WITHIN_S)

        def run(self) -> None:
            self._silence.close()
            super().run()

    class _Context(ForkServerContext):
        Process = _BegunProcess


def context() -> BaseContext:
    """Return how processes are to be started; to be called shortly before."""
    # New interpreters look for modules in the current folder first: a user's file named like one of the
    # standard library would be executed.
    if sys.platform == "win32" or sys.platform == "darwin":
        os.environ.setdefault("PYTHONSAFEPATH", "1")  # each process is a new interpreter
        return get_context("spawn")  # system libraries of macOS do not bear to be copied
    else:
        found = _Context()
        found.set_forkserver_preload([*LOADED])
        path = os.pathsep.join(place or os.getcwd() for place in sys.path)
        # What this program imports, the processes can import, also where it has changed ``sys.path``.
        with _starting, _variables(PYTHONSAFEPATH="1", PYTHONPATH=path):
            forkserver.ensure_running()
        return found


def cores() -> int:
    """Return the number of cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def hold_back(number: signal.Signals) -> Callable[[], None]:
    """Let a signal wait, of which started processes are to know nothing; what is returned lets it come."""
    if threading.current_thread() is not threading.main_thread():
        return lambda: None
    held: list[int] = []
    before = signal.signal(number, lambda came, frame: held.append(came))

    def let_come() -> None:
        signal.signal(number, before)
        if held:
            signal.raise_signal(number)

    return let_come


@contextmanager
def _variables(**values: str) -> Iterator[None]:
    """Set variables of the environment for new processes, and leave no trace of that in this one."""
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
