"""Egos that stood for too long with a free road.

Stretches longer than deadlock_s at or below standing_speed_mps in which no vehicle was ever within
deadlock_free_gap_m ahead; within deadlock_signal_range_m of a crossing with signals, where a red phase
may last, longer than deadlock_signal_s.

Undefined: never. Steps without a recorded gap count as free.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.stretches import stretches
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (column.count("deadlock", "egos that stood for too long with a free road", required=True),)


def compute(case: Case) -> Values:
    """Return the number of stretches."""
    limits = case.thresholds
    number = case.run.egos.numbers
    signals = [area.shape for area in case.run.crossings() if area.crossing_kind == "signal"]
    count = 0
    for track in case.egos:
        rows = track.rows[:: case.grid.factor]
        time, gap = number["time_s"][rows], number["gap_ahead_m"][rows]
        for first, last in stretches(number["speed_mps"][rows] <= limits.standing_speed_mps):
            lasted = time[last] - time[first]
            if lasted <= limits.deadlock_s or (gap[first : last + 1] < limits.deadlock_free_gap_m).any():
                continue
            x, y = track.x[first * case.grid.factor], track.y[first * case.grid.factor]
            near = any(
                np.hypot(shape[:, 0] - x, shape[:, 1] - y).min() < limits.deadlock_signal_range_m
                for shape in signals
            )
            count += bool(not near or lasted > limits.deadlock_signal_s)
    return {"deadlock": count}
