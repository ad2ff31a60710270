"""Reads times of day as people type them."""

from __future__ import annotations

import re

from cosim.errors import InputError

_CLOCK = re.compile(r"(\d{1,3}):([0-5]\d)(?::([0-5]\d))?")


def seconds(text: str, option: str) -> float:
    """Return the simulated time of a text such as ``07:30``, ``7:30:15`` or ``27000`` [s].

    Raises
    ------
    InputError
        If the text is not such a time.

    Examples
    --------
    >>> seconds("07:30", "--from")
    27000.0
    """
    if match := _CLOCK.fullmatch(text.strip()):
        hours, minutes, rest = match.groups(default="0")
        return 3600.0 * int(hours) + 60.0 * int(minutes) + int(rest)
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < float("inf"):
        raise InputError(f"{option} {text}: expected a time such as 07:30 or 27000 (seconds)")
    return value
