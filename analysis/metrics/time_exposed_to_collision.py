"""Time exposed to a low time to collision (TET).

TET(tau) is the time in the encounter during which 0 <= TTC <= tau, for tau = 1.5 s and 3.0 s:
the sum of the durations of these samples.

Undefined: never; 0 without a collision course. The run's value is the sum over its encounters.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import TTC_EXPOSURE_LIMITS_S, in_name

UNIT = "s"
WORSE = "higher"
SOURCE = "[MinderhoudBovy2001]"
COLUMNS = (
    column.at_least_0("tet_1p5_s", "s", "time with TTC of at most 1.5 s", required=True),
    column.at_least_0("tet_3p0_s", "s", "time with TTC of at most 3.0 s", required=True),
)
RUN_COLUMNS = (column.at_least_0("tet_1p5_s", "s", "time with TTC of at most 1.5 s", required=True),)


def compute(case: Case) -> Values:
    """Return the time below both limits."""
    samples = case.samples
    return {
        f"tet_{in_name(limit)}_s": samples.total(np.where(samples.ttc <= limit, samples.duration, 0.0))
        for limit in TTC_EXPOSURE_LIMITS_S
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the sum over all encounters."""
    return {"tet_1p5_s": float(np.sum(columns["tet_1p5_s"]))}
