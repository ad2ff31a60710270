"""Resident memory of this process over simulated time, and how it grows."""

from __future__ import annotations

import resource
from collections.abc import Mapping, Sequence

import numpy as np
import psutil

HOUR_S = 3600.0
EVERY_S = 30.0


class Looks:
    """Resident memory of this process, looked at now and then."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        self.found: dict[str, list[float]] = {"time_s": [], "resident_mb": []}

    def look(self, now: float) -> None:
        """Look, if the last time is long enough ago in simulated time [s]."""
        times = self.found["time_s"]
        if not times or now - times[-1] >= EVERY_S - 1e-6:
            times.append(now)
            self.found["resident_mb"].append(self._process.memory_info().rss / 1e6)

    @staticmethod
    def most_mb() -> float:
        """Return the most memory that this process has ever held [MB]."""
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def settled(seen: Mapping[str, Sequence[float]], settled_s: float) -> tuple[list[float], list[float]]:
    """Return times [s] and sizes [MB] from a time on."""
    rows = [row for row in zip(seen["time_s"], seen["resident_mb"], strict=True) if row[0] >= settled_s]
    return [time for time, _ in rows], [size for _, size in rows]


def slope(times_s: Sequence[float], sizes_mb: Sequence[float]) -> float:
    """Return the slope of the straight line that fits best [MB/h]."""
    return HOUR_S * float(np.polyfit(times_s, sizes_mb, 1)[0])
