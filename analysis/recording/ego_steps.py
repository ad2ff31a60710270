"""State of an ego's ride in each recorded step; arrays over the rows of egos.parquet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Track
from analysis.thresholds import Thresholds


@dataclass(frozen=True, slots=True)
class EgoSteps:
    """One value for each recorded row of the egos."""

    duration: FloatArray
    """Time until the next row of the same track; 0 at its end [s]."""
    distance: FloatArray
    """Distance driven until the next row [m]."""
    jerk: FloatArray
    """Mean jerk over the window that ends at the row; nan where it begins before the track [m/s^3]."""
    jerk_from: FloatArray
    """Beginning of that window [s]."""
    lateral_acceleration: FloatArray
    """Speed times yaw rate until the next row; nan at a track's end [m/s^2]."""
    deceleration: FloatArray
    """Positive while braking [m/s^2]."""


def ego_steps(run: RecordedRun, egos: Sequence[Track], grid: Grid, thresholds: Thresholds) -> EgoSteps:
    """Return the derived values of every recorded row of the egos."""
    count = len(run.egos)
    number = run.egos.numbers
    duration, distance = np.zeros(count), np.zeros(count)
    jerk, jerk_from = np.full(count, np.nan), np.full(count, np.nan)
    lateral = np.full(count, np.nan)
    window = max(1, round(thresholds.jerk_window_s / run.step_s))
    for track in egos:
        rows = track.rows[:: grid.factor]
        if len(rows) < 2:
            continue
        time, speed = number["time_s"][rows], number["speed_mps"][rows]
        acceleration = number["acceleration_mps2"][rows]
        step = np.diff(time)
        duration[rows[:-1]] = step
        distance[rows[:-1]] = np.diff(track.path[:: grid.factor])
        yaw = np.diff(track.heading[:: grid.factor]) / step
        lateral[rows[:-1]] = 0.5 * (speed[1:] + speed[:-1]) * yaw
        if len(rows) > window:
            ends, begins = rows[window:], rows[:-window]
            span = time[window:] - time[:-window]
            jerk[ends] = (acceleration[window:] - acceleration[:-window]) / span
            jerk_from[ends] = number["time_s"][begins]
    return EgoSteps(
        duration=duration,
        distance=distance,
        jerk=jerk,
        jerk_from=jerk_from,
        lateral_acceleration=lateral,
        deceleration=np.maximum(-number["acceleration_mps2"], 0.0),
    )
