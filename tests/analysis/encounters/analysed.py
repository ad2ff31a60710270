"""What comes of a recorded run with one ego."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from analysis.results.analyse import RunReport, analyse_run
from tests.analysis.recorded import Ego, Person, write_run


def crosses(start: float, end: float, waits_from: float = -1e9) -> Callable[[float], str]:
    """Return the phase of a person who is on the crossing between two instants."""

    def phase(t: float) -> str:
        if start <= t <= end:
            return "crossing"
        return "waiting" if waits_from <= t < start else "walking"

    return phase


def analyse(folder: Path, ego: Ego, *persons: Person, **keys: Any) -> RunReport:
    return analyse_run(write_run(folder, [ego], persons, **keys))


def only(report: RunReport) -> dict[str, Any]:
    (row,) = report.encounters
    return dict(row)
