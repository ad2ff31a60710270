"""The error tree. Every error a user can cause is one line that says what was expected and what exists.

CosimError
├── InputError          found before the first step: exit code 2
└── SimulationError     after the first step: the run is invalid, what was recorded is kept, exit code 3
"""

from __future__ import annotations

import errno
import os

_OF_ZSTD = "Allocation error"
"""Message of zstd when memory runs out, which pyarrow reports as an error of the file."""


class CosimError(Exception):
    """Base of all errors that this project raises on purpose; the text is one line for the user."""


class InputError(CosimError):
    """Bad usage or bad input, found before the first step."""


class SimulationError(CosimError):
    """A run began but could not go on."""


def reason_of(error: Exception) -> str:
    """Return why something failed, without the names of unfinished files.

    >>> reason_of(OSError(28, "No space left on device", "egos.parquet.part"))
    'No space left on device'
    """
    return os.strerror(error.errno) if isinstance(error, OSError) and error.errno else str(error)


def lacks_memory(error: OSError) -> bool:
    """Return whether what is reported as an error of a file is a want of memory.

    >>> lacks_memory(OSError(errno.ENOMEM, "Cannot allocate memory")), lacks_memory(OSError(28, "No space"))
    (True, False)
    """
    return error.errno == errno.ENOMEM or (error.errno is None and _OF_ZSTD in str(error))
