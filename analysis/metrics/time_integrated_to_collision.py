"""Time-integrated time to collision (TIT).

TIT(tau) is the integral over the encounter of (tau − TTC) where TTC < tau, for tau = 1.5 s and 3.0 s,
as a sum over samples.

Undefined: never; 0 without a collision course. The run's value is the sum over its encounters.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import TTC_EXPOSURE_LIMITS_S, in_name

UNIT = "s^2"
WORSE = "higher"
SOURCE = "[MinderhoudBovy2001]"
COLUMNS = (
    column.at_least_0("tit_1p5_s2", "s^2", "integral of 1.5 s − TTC", required=True),
    column.at_least_0("tit_3p0_s2", "s^2", "integral of 3.0 s − TTC", required=True),
)
RUN_COLUMNS = (column.at_least_0("tit_1p5_s2", "s^2", "integral of 1.5 s − TTC", required=True),)


def compute(case: Case) -> Values:
    """Return the integrals for both limits."""
    samples = case.samples
    return {
        f"tit_{in_name(limit)}_s2": samples.total(
            np.where(samples.ttc <= limit, limit - samples.ttc, 0.0) * samples.duration
        )
        for limit in TTC_EXPOSURE_LIMITS_S
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the sum over all encounters."""
    return {"tit_1p5_s2": float(np.sum(columns["tit_1p5_s2"]))}
