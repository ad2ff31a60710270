"""Planned paths of a recorded run, for drawing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.arrays import FloatArray
from analysis.recording.opening import opened_table


@dataclass(frozen=True, slots=True)
class PlannedPath:
    """Planned path of an ego's rear axle."""

    time_s: float
    """Time at which it was planned."""
    points: FloatArray
    """(n, 2) [m]"""


def read_plans(folder: Path, ego: str) -> list[PlannedPath]:
    """Return the recorded plans of an ego in order of time.

    Raises
    ------
    RecordingError
        If plans.parquet is missing or cannot be read.
    """
    with opened_table(folder / "plans.parquet") as file:
        table = file.read(columns=["time_s", "ego_id", "x_m", "y_m"])
    return [
        PlannedPath(row["time_s"], np.column_stack([row["x_m"], row["y_m"]]))
        for row in table.to_pylist()
        if row["ego_id"] == ego
    ]
