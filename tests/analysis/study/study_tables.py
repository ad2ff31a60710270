"""Runs whose numbers can be added up by hand, and the tables made from them."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from analysis.study.writing import write_tables
from tests.analysis.study.study_folders import write_study_run

Cells = dict[str, str]


def read(path: Path) -> list[Cells]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(out: Path, folders: list[Path], baseline: str | None = None) -> tuple[list[Cells], list[Cells]]:
    """Write the tables and return the rows of configs.csv and comparisons.csv."""
    write_tables(out, folders, baseline)
    return read(out / "configs.csv"), read(out / "comparisons.csv")


def only(rows: list[Cells], **cells: str) -> Cells:
    (row,) = [row for row in rows if all(row[name] == value for name, value in cells.items())]
    return row


def met(ttc: float | None = None, **cells: Any) -> dict[str, Any]:
    return {"min_ttc_s": ttc, **cells}


def two_controllers(folder: Path) -> list[Path]:
    """Write three seeds of `slow` and `sumo`: delays 10, 20, 30 and 13, 22, 34; some TTC below 1.5 s."""
    found = []
    for seed, (delay, more) in enumerate(((10.0, 3.0), (20.0, 2.0), (30.0, 4.0)), start=1):
        for name, value, low in (("sumo", delay, 2), ("slow", delay + more, 0)):
            encounters = [met(1.0)] * low + [met(4.0)] * (4 - low) + [met(0.5, entered=False)]
            numbers = {"ego_delay_mean_s": value, "n_conflicts": low, "ego_dist_km": 2.0}
            run = folder / f"{name}-{seed}"
            found.append(write_study_run(run, name, seed, numbers=numbers, encounters=encounters))
    return found
