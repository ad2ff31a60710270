"""A command in a process of its own: if SUMO crashes, the parent process reports it."""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

OWN_PROCESS = "own process"
"""Whether the command line has its process for itself; not so where a program calls it."""

UNREPORTED = 1
CRASHES = {UNREPORTED: "an error that it could not report", errno.ENOMEM: "want of memory"}
"""Exit codes by which `cosim run` means nothing: Python's own after an exception that nothing caught, and
`Inside.give_up`'s."""


@dataclass(frozen=True, slots=True)
class Ended:
    """End of the process, as sent to the parent process."""

    code: int
    signal: str
    """Name of the signal that ended it; empty where it ended by itself."""
    told: str
    """What it had told."""

    @property
    def crash(self) -> str:
        """What ended it before it could report; empty where it reported."""
        return self.signal or CRASHES.get(self.code, "")


@dataclass(frozen=True, slots=True)
class Inside:
    """Input of the new process."""

    pipe: int = -1

    def tell(self, folder: Path) -> None:
        """Leave word of where the run is recorded."""
        if self.pipe >= 0:
            os.write(self.pipe, str(folder.resolve()).encode())

    def give_up(self, error: MemoryError | SystemError) -> None:
        """End the new process, which cannot finish its files; without one, do nothing.

        Where memory is short, the interpreter's own calls may fail without saying why: a ``SystemError``.
        """
        if self.pipe >= 0:
            os._exit(errno.ENOMEM if isinstance(error, MemoryError) else UNREPORTED)


def begin() -> Inside | Ended:
    """Go on in a new process; in the one that called, wait for its end and return how that was.

    Where the system cannot copy a process, the command goes on in this one.
    """
    if not hasattr(os, "fork"):
        return Inside()
    sys.stdout.flush()
    sys.stderr.flush()
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        sys.unraisablehook = _unless_memory
        return Inside(writer)
    os.close(writer)
    # Ctrl-C reaches every process of a terminal: the new one ends in good order, this one waits for it.
    before = {number: signal.signal(number, _passed_to(child)) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with os.fdopen(reader, encoding="utf-8") as told:
            text = told.read()
        _, status = os.waitpid(child, 0)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    code = os.waitstatus_to_exitcode(status)
    return Ended(code, signal.Signals(-code).name if code < 0 else "", text)


def _unless_memory(told: sys.UnraisableHookArgs) -> None:
    """Tell of an exception in a destructor, but not that it found no memory: the run's last line does."""
    if not issubclass(told.exc_type, MemoryError):
        sys.__unraisablehook__(told)


def _passed_to(child: int) -> Callable[[int, FrameType | None], None]:
    def handle(number: int, frame: FrameType | None) -> None:
        if number == signal.SIGTERM:
            os.kill(child, number)

    return handle
