"""The error tree. Every error a user can cause is one line that says what was expected and what exists.

CosimError
├── InputError          found before the first step: exit code 2
└── SimulationError     after the first step: the run is invalid, what was recorded is kept, exit code 3
"""

from __future__ import annotations

import os


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
