"""Completed lane changes of the egos.

A change of the lane number that is kept for at least lane_change_hold_s, or until the ego's recording
ends.

Undefined: never; 0 where no lane number was recorded.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
RUN_COLUMNS = (column.count("n_lane_changes", "completed lane changes", required=True),)


def collect_rides(case: Case) -> Values:
    """Return the number of lane changes of each ego."""
    number, time = case.run.egos.numbers["lane_number"], case.run.egos.numbers["time_s"]
    hold = case.thresholds.lane_change_hold_s
    counts = []
    for name in sorted({track.name for track in case.egos}):
        rows = np.concatenate([t.rows[:: case.grid.factor] for t in case.egos if t.name == name])
        rows = rows[np.isfinite(number[rows])]
        if len(rows) == 0:
            continue
        starts = np.concatenate([[0], np.flatnonzero(np.diff(number[rows])) + 1])
        ends = np.append(time[rows[starts[1:]]], time[rows[-1]])
        stays = ends - time[rows[starts]] >= hold - 1e-9
        stays[[0, -1]] = True  # it need not stay in the lane that it comes from
        lanes = number[rows[starts]][stays]
        counts.append(int((np.diff(lanes) != 0.0).sum()))
    return {"counts": counts}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of lane changes."""
    return {"n_lane_changes": sum(columns["counts"])}
