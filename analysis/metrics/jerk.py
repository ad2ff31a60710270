"""Largest jerk of the ego, until it has left the conflict area.

The mean jerk over jerk_window_s: difference of the recorded acceleration over the window, whose whole
length lies in the encounter. At steps longer than the window the window is one step. The run's 95th
percentile is taken over all steps of all egos.

Undefined: empty for encounters shorter than the window.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "m/s^3"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = (column.at_least_0("ego_max_abs_jerk_mps3", "m/s^3", "largest jerk of the ego"),)
RUN_COLUMNS = (column.at_least_0("p95_abs_jerk_mps3", "m/s^3", "95th percentile of the jerk over all steps"),)


def compute(case: Case) -> Values:
    """Return the largest absolute jerk."""
    time = case.run.egos.numbers["time_s"]
    value = np.full(len(case), np.nan)
    for i, rows in enumerate(case.ego_rows):
        inside = rows[case.steps.jerk_from[rows] >= time[rows[0]] - 1e-9] if len(rows) else rows
        if len(inside):
            value[i] = np.abs(case.steps.jerk[inside]).max()
    return {"ego_max_abs_jerk_mps3": value}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the 95th percentile over all steps."""
    jerk = np.abs(whole.steps.jerk[np.isfinite(whole.steps.jerk)])
    return {"p95_abs_jerk_mps3": np.percentile(jerk, 95.0) if len(jerk) else None}
