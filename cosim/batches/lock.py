"""A file lock that other processes respect, on every operating system."""

from __future__ import annotations

import sys
from typing import IO


def take(file: IO[str]) -> None:
    """Lock a file that is open for writing, until it is closed.

    Raises
    ------
    BlockingIOError
        If another process has locked it.
    """
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError as error:
            raise BlockingIOError(*error.args) from error
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
