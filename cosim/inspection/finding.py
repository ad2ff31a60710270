"""One thing that was found, how bad it is, and the command that mends it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Level(StrEnum):
    """How much a finding matters."""

    GOOD = "good"
    NOTE = "note"
    """Worth knowing."""
    DANGER = "danger"
    """A run works, and its numbers do not mean what one thinks."""
    MISSING = "missing"
    """No study is possible before it is mended."""


@dataclass(frozen=True, slots=True)
class Finding:
    """The answer of one check."""

    check: str
    level: Level
    text: str
    command: str = ""
    """What mends it; empty where nothing has to be mended, or no command can."""
