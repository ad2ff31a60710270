"""Planned paths of a recorded run, for drawing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.errors import RecordingError
from analysis.geometry import FloatArray


@dataclass(frozen=True, slots=True)
class PlannedPath:
    """Planned path of an ego's rear axle."""

    time_s: float
    """When it was planned."""
    points: FloatArray
    """(n, 2) [m]"""


def read_plans(folder: Path, ego: str) -> list[PlannedPath]:
    """Return the recorded plans of an ego in order of time.

    Raises
    ------
    RecordingError
        If plans.parquet is missing or cannot be read.
    """
    path = folder / "plans.parquet"
    try:
        table = pq.read_table(path, columns=["time_s", "ego_id", "x_m", "y_m"])
    except FileNotFoundError:
        raise RecordingError(f"{path}: no such file") from None
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: truncated or not Parquet ({reason})") from None
    return [
        PlannedPath(row["time_s"], np.column_stack([row["x_m"], row["y_m"]]))
        for row in table.to_pylist()
        if row["ego_id"] == ego
    ]
