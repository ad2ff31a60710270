"""Errors in recorded runs, thresholds and metrics."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class AnalysisError(ValueError):
    """Bad input to an analysis; its text is one line for the user."""


class RecordingError(AnalysisError):
    """A recorded run that cannot be analysed; the text names file, column and row, if there is one."""


class DamageError(RecordingError):
    """A file of a run or a study was altered or lost; the text names the file and a remedy."""


class ThresholdError(AnalysisError):
    """A threshold that does not exist or whose value cannot be read."""


class StudyError(AnalysisError):
    """Runs that cannot be summarised or compared together; the text names what exists."""


class MetricError(AnalysisError):
    """A metric whose file is incomplete, or that returns something it does not declare."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a question that names the known name nearest to a wrong one, or nothing if none is near.

    >>> did_you_mean("horizn", ["horizon", "solver"])
    "did you mean 'horizon'? "
    """
    near = difflib.get_close_matches(name, list(known), n=1)
    return f"did you mean {near[0]!r}? " if near else ""
