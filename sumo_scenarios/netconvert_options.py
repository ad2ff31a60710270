"""Options of netconvert that a scenario may set: how a network is built, but never names of files."""

from __future__ import annotations

import re
from collections.abc import Sequence

ALLOWED = (
    "bikelanes.",
    "check-lane-foes.",
    "crossings.",
    "default.",
    "edges.join",
    "fringe.",
    "geometry.",
    "internal-junctions.",
    "join-lanes",
    "junctions.",
    "keep-edges.",
    "keep-nodes-unregulated",
    "lefthand",
    "max-join-ids",
    "no-internal-links",
    "no-left-connections",
    "no-turnarounds",
    "offset.",
    "opposites.",
    "precision",
    "ramps.",
    "rectangular-lane-cut",
    "remove-edges.",
    "roundabouts.",
    "sidewalks.",
    "speed.",
    "tls.",
    "walkingareas",
)
"""Prefixes of the allowed options."""
_NAMES_FILE = re.compile(r".*(input-file|output).*")
_NUMBER = re.compile(r"-[\d.]+")


def check_options(words: Sequence[str]) -> None:
    """Refuse arguments for netconvert that are neither an allowed option nor the value of one.

    Raises
    ------
    ValueError
        If a word is refused; the message is one line that names it and says what is allowed.

    Examples
    --------
    >>> check_options(["--tls.cycle.time", "60", "--junctions.join", "--tls.layout=incoming"])
    """
    value_may_follow = False
    for word in words:
        if not word.startswith("-") or _NUMBER.fullmatch(word):
            if not value_may_follow:
                raise ValueError(f"network.netconvert: {word!r}: expected an option like --tls.layout")
            value_may_follow = False
            continue
        option, equals, _ = word.partition("=")
        if not option.startswith("--") or not is_allowed(option.removeprefix("--")):
            raise ValueError(
                f"network.netconvert: {option!r} is not allowed; allowed are options that neither read nor "
                f"write files and begin with --{', --'.join(ALLOWED)}"
            )
        value_may_follow = not equals


def is_allowed(name: str) -> bool:
    """Return whether a scenario may set an option of netconvert.

    >>> is_allowed("tls.layout"), is_allowed("junctions.join-output")
    (True, False)
    """
    return name.startswith(tuple(ALLOWED)) and not _NAMES_FILE.fullmatch(name)
