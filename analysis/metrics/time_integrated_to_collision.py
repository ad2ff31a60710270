"""Time-integrated time to collision (TIT).

TIT(tau) is the integral over the encounter of (tau − TTC) where TTC < tau, for tau = 1.5 s and 3.0 s,
as a sum over samples.

Undefined: never; 0 without a collision course. The run's value is the sum over its encounters.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "s^2"
WORSE = "higher"
SOURCE = "[MinderhoudBovy2001]"
COLUMNS = ("tit_1p5_s2", "tit_3p0_s2")
RUN_COLUMNS = ("tit_1p5_s2",)


def compute(case: Case) -> Values:
    """Return the integrals for both limits."""
    samples = case.samples
    return {
        name: samples.total(np.where(samples.ttc <= limit, limit - samples.ttc, 0.0) * samples.duration)
        for name, limit in (("tit_1p5_s2", 1.5), ("tit_3p0_s2", 3.0))
    }


def summarise(case: Case, columns: Values) -> Values:
    """Return the sum over all encounters."""
    return {"tit_1p5_s2": float(np.sum(columns["tit_1p5_s2"]))}
