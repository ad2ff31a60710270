"""Counts the people around an ego that is near a crossing."""

from __future__ import annotations

import numpy as np

from analysis.arrays import FloatArray
from analysis.recording.reading import RecordedRun

NEAR_M = 45.0
"""Within this distance, people are near an ego and an ego is near a crossing; encounters begin there [m]."""
EVERY_S = 1.0
"""How often the people near an ego are counted [s]."""


def people_at_once(run: RecordedRun) -> float | None:
    """Return the mean number of pedestrians near an ego that is near a crossing; ``None`` if it never is."""
    egos, others = run.egos.numbers, run.neighbours.numbers
    people = np.flatnonzero(run.neighbours.texts["object_kind"].equal("pedestrian"))
    people = people[np.argsort(others["time_s"][people], kind="stable")]
    times = others["time_s"][people]
    counts = []
    for row in np.flatnonzero(_near_a_crossing(run) & _on_the_second(egos["time_s"])):
        now = egos["time_s"][row]
        here = people[slice(*np.searchsorted(times, (now - 1e-6, now + 1e-6)))]
        away = np.hypot(
            others["x_m"][here] - egos["front_x_m"][row], others["y_m"][here] - egos["front_y_m"][row]
        )
        counts.append(np.count_nonzero(away < NEAR_M))
    return float(np.mean(counts)) if counts else None


def _near_a_crossing(run: RecordedRun) -> np.ndarray:
    x, y = run.egos.numbers["front_x_m"], run.egos.numbers["front_y_m"]
    near = np.zeros(len(x), dtype=bool)
    for area in run.crossings():
        for (x0, y0), (x1, y1) in zip(area.shape[:-1], area.shape[1:], strict=True):
            length = max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
            share = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length, 0.0, 1.0)
            near |= np.hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y) < NEAR_M
    return near


def _on_the_second(times: FloatArray) -> np.ndarray:
    return np.abs(times - EVERY_S * np.round(times / EVERY_S)) < 1e-6
