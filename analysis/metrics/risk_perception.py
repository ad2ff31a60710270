"""Risk-perception coefficient k of the velocity-obstacle paper, mean over the approach.

k = l / v with the way l still to go to the conflict area and the speed v, averaged over the samples of
the encounter before the ego enters, with the ego faster than moving_speed_mps. The run's value is the
mean over its encounters.

Undefined: empty without a conflict area, and where the ego is in it from the beginning.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import ride_of
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "Eq. (32) of [VOMPC2019]"
COLUMNS = (column.at_least_0("k_mean_s", "s", "mean risk-perception coefficient of the approach"),)
RUN_COLUMNS = (column.at_least_0("k_mean_s", "s", "mean risk-perception coefficient"),)


def compute(case: Case) -> Values:
    """Return the mean k of each encounter."""
    mean = np.full(len(case), np.nan)
    for i, one in enumerate(case.encounters):
        if one.area is None:
            continue
        ride = ride_of(case, one.ego)
        inside = slice(one.first - one.ego.first, one.last - one.ego.first + 1)
        time, speed, path = ride.time[inside], ride.speed[inside], ride.path[inside]
        chosen = (time < one.area.ego.enter) & (speed > case.thresholds.moving_speed_mps)
        if chosen.any():
            end = float(np.interp(one.area.ego.enter, ride.time, ride.path))
            mean[i] = float(((end - path[chosen]) / speed[chosen]).mean())
    return {"k_mean_s": mean}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the mean over encounters."""
    values = np.asarray(columns["k_mean_s"])
    known = values[np.isfinite(values)]
    return {"k_mean_s": known.mean() if len(known) else None}
