"""Simulates a run and analyses its recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError
from analysis.results.analyse import analyse_run
from cosim.errors import SimulationError, reason_of
from cosim.presentation.numbers import Row, read_row
from cosim.running.request import RunRequest
from cosim.running.simulation import Progress, RunResult, keep_recorded, run


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of one run for the user."""

    folder: Path
    description: dict[str, Any]
    """The content of ``run.json``."""
    row: Row | None
    """The run's row of ``runs.csv``; ``None`` if too little was recorded to analyse."""
    invalid_reason: str
    """Why the run is not valid, in one line; empty for a valid run."""
    error: BaseException | None = None
    """Error that ended the run early, for debugging; ``None`` if there was none."""


def execute(
    request: RunRequest,
    progress: Progress = lambda time, end: None,
    begun: Callable[[Path], None] = lambda folder: None,
) -> Outcome:
    """Simulate one run, analyse it, and return its numbers.

    A run that failed after its first step is analysed up to the point to which it was recorded.

    Raises
    ------
    InputError
        If anything is found wrong before the first step.
    """
    return _analysed(run(request, progress, begun))


def salvage(folder: Path, reason: str) -> Outcome:
    """Analyse what was recorded of a run whose process crashed, and return the outcome.

    Parameters
    ----------
    folder : folder of the run
    reason : how the process ended
    """
    return _analysed(RunResult(folder, keep_recorded(folder, reason)))


def _analysed(result: RunResult) -> Outcome:
    row: Row | None = None
    try:
        analyse_run(result.folder)
        row = read_row(result.folder)
    except (AnalysisError, OSError) as error:
        if result.valid:
            raise SimulationError(f"{result.folder} could not be analysed: {reason_of(error)}") from error
        # An early end may leave nothing to analyse; the user is told what went wrong before.
    return Outcome(result.folder, result.description, row, result.invalid_reason, result.error)
