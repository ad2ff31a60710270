"""Time exposed to a low time to collision (TET).

TET(tau) is the time in the encounter during which 0 <= TTC <= tau, for tau = 1.5 s and 3.0 s:
the sum of the durations of these samples.

Undefined: never; 0 without a collision course. The run's value is the sum over its encounters.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "s"
WORSE = "higher"
SOURCE = "[MinderhoudBovy2001]"
COLUMNS = ("tet_1p5_s", "tet_3p0_s")
RUN_COLUMNS = ("tet_1p5_s",)


def compute(case: Case) -> Values:
    """Return the time below both limits."""
    samples = case.samples
    return {
        name: samples.total(np.where(samples.ttc <= limit, samples.duration, 0.0))
        for name, limit in (("tet_1p5_s", 1.5), ("tet_3p0_s", 3.0))
    }


def summarise(case: Case, columns: Values) -> Values:
    """Return the sum over all encounters."""
    return {"tet_1p5_s": float(np.sum(columns["tet_1p5_s"]))}
