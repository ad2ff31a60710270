"""Verdicts as a check writes them, by hand."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.criteria.table import CRITERIA
from analysis.tables.cells import cells

FAILED = {
    "target": "road",
    "scenario_id": "road",
    "controller": "sumo",
    "configuration": "sumo",
    "scope": "run",
    "criterion_id": "by hand",
    "metric": "min_dist_m",
    "operator": "==",
    "threshold": 0.0,
    "value": 1.0,
    "margin": -1.0,
    "status": "fail",
    "unit": "1",
    "counts": True,
    "place": "at crossing c",
}


def write_criteria(folder: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write criteria.csv; what a row does not say is that of one that failed."""
    with (folder / CRITERIA.file).open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([CRITERIA.names(), *cells(CRITERIA, [FAILED | dict(row) for row in rows])])
