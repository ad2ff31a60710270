"""Resident memory of this process over simulated time, and how it grows."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import psutil

from analysis.markdown import table_of

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


def in_process(script: str, *arguments: str) -> dict[str, Any]:
    """Return what a benchmark's script prints as its last line, in a process of its own."""
    done = subprocess.run([sys.executable, script, *arguments], stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"{arguments[0]} ended with {done.returncode}")
    seen: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return seen


def settled(seen: Mapping[str, Sequence[float]], settled_s: float) -> tuple[list[float], list[float]]:
    """Return times [s] and sizes [MB] from a time on."""
    rows = [row for row in zip(seen["time_s"], seen["resident_mb"], strict=True) if row[0] >= settled_s]
    return [time for time, _ in rows], [size for _, size in rows]


def slope(times_s: Sequence[float], sizes_mb: Sequence[float]) -> float:
    """Return the slope of the straight line that fits best [MB/h]."""
    return HOUR_S * float(np.polyfit(times_s, sizes_mb, 1)[0])


def table(found: Mapping[str, Any], rows: int, heading: str, time: Callable[[float], str]) -> str:
    """Return about so many of the looks as a Markdown table; ``time`` says how the times [s] are written."""
    looks = list(zip(found["time_s"], found["resident_mb"], strict=True))
    return table_of(
        [
            {heading: time(now), "resident MB": f"{size:.0f}"}
            for now, size in looks[:: max(1, len(looks) // rows)]
        ]
    )
