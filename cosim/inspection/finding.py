"""A finding of one check, its severity, and the command that fixes it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Level(StrEnum):
    """Severity of a finding."""

    GOOD = "good"
    NOTE = "note"
    """Worth knowing, but no reason not to run a study."""
    DANGER = "danger"
    """A run works, but its numbers do not mean what the user would expect."""
    MISSING = "missing"
    """No study is possible before this is fixed."""


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check."""

    check: str
    level: Level
    text: str
    command: str = ""
    """Command that fixes the problem; empty if there is none, or no command can fix it."""
