"""Limits of a process that is made to go wrong, so that it cannot take the machine with it."""

from __future__ import annotations

import resource

LARGEST_FILE = 64 << 20
"""[bytes]"""


def limit(most_memory: int, largest_file: int = LARGEST_FILE) -> None:
    """Limit this process and those that it starts.

    Parameters
    ----------
    most_memory : int
        Of addresses, of which libraries reserve much more than they use [bytes].
    largest_file : int
        That it may write [bytes].
    """
    for what, most in (
        (resource.RLIMIT_AS, most_memory),
        (resource.RLIMIT_FSIZE, largest_file),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(what, (most, most))
