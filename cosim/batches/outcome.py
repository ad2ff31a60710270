"""Outcome of one attempt at a run."""

from __future__ import annotations

import errno
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.batches.job import Job

RUN = "run"
"""Folder of the run inside the folder of an attempt."""
LOG = "log.txt"
"""File beside the run's folder with all that the attempt wrote to its output streams."""
REASON = "reason.txt"
NOTE = "job.json"
"""File inside the run's folder that says how the study asked for the run."""
LAST_LINES = 40
LONGEST_LINE = 300

# After any of these errors, no further run can be expected to succeed.
_FULL = tuple(os.strerror(code) for code in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG))


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of one finished attempt at a run."""

    job: Job
    folder: Path
    """Folder of the attempt."""
    reason: str = ""
    """Why there is no run, in one line; empty if there is one."""
    lost: bool = False
    """Whether the attempt ended through no fault of the run."""

    @property
    def disk_full(self) -> bool:
        """Whether the run failed because the disk is full."""
        return says_full(self.reason)

    def last_lines(self) -> Sequence[str]:
        """Return the end of what the attempt wrote to its output streams."""
        try:
            text = (self.folder / LOG).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ()
        return [line[:LONGEST_LINE] for line in text.splitlines()[-LAST_LINES:]]


def says_full(text: str) -> bool:
    """Return whether an error message says that there is no room for files."""
    return any(words in text for words in _FULL)
