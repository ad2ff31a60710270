"""Share of plans that had to violate a soft constraint by more than slack_m.

For an encounter: plans until the ego has left the conflict area.

Undefined: empty without plans.
"""

from __future__ import annotations

import numpy as np

from analysis.arrays import IntArray
from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.recording.reading import RecordedRun
from analysis.tables import column
from analysis.thresholds import Thresholds

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (column.share("slack_share", "share of plans that violated a soft constraint"),)
RUN_COLUMNS = (column.share("slack_share", "share of plans that violated a soft constraint"),)


def compute(case: Case) -> Values:
    """Return the share of each encounter."""
    return {"slack_share": np.array([_share(case.run, rows, case.thresholds) for rows in case.ego_rows])}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the share of the run."""
    return {"slack_share": _share(whole.run, np.arange(len(whole.run.egos)), whole.thresholds)}


def _share(run: RecordedRun, rows: IntArray, thresholds: Thresholds) -> float:
    planned = rows[run.egos.flags["planned"][rows]]
    if len(planned) == 0:
        return np.nan
    return float((run.egos.numbers["slack_m"][planned] > thresholds.slack_m).mean())
