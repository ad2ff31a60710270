"""A run and its numbers: simulate, then analyse what was recorded."""

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
    """The run's row of ``runs.csv``; ``None`` when too little was recorded to analyse."""
    invalid_reason: str
    """Empty for a valid run."""
    error: BaseException | None = None
    """What ended the run before its time, for who looks for a defect; ``None`` where nothing did."""


def execute(
    request: RunRequest,
    progress: Progress = lambda time, end: None,
    begun: Callable[[Path], None] = lambda folder: None,
) -> Outcome:
    """Simulate one run, analyse it, and return its numbers.

    A run that went wrong after its first step is analysed as far as it was recorded.

    Raises
    ------
    InputError
        For anything wrong that is found before the first step.
    """
    return _analysed(run(request, progress, begun))


def salvage(folder: Path, reason: str) -> Outcome:
    """Return the analysed rest of a run whose process ended without a message.

    Parameters
    ----------
    folder : of the run
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
        # An early end may leave nothing to analyse; what went wrong before is what the user is told.
    return Outcome(result.folder, result.description, row, result.invalid_reason, result.error)
