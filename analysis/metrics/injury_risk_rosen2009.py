"""Risk that the pedestrian dies, after Rosén and Sander.

P = 1 / (1 + exp(6.9 − 0.090 v)) with the impact speed v [km/h]; adults hit by car fronts. Curves of
other authors differ by more than a factor of ten at 30 to 40 km/h: the curve's name is in the column.

Undefined: empty without a collision. The run's value is the sum, 0 without collisions.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "[RosenSander2009], coefficients as restated in later work"
CURVE = "P = 1 / (1 + exp(6.9 - 0.090 v)), v in km/h"
COLUMNS = (column.share("p_fatal_rosen2009", "risk of death at the impact speed"),)
RUN_COLUMNS = (column.at_least_0("sum_p_fatal_rosen2009", "1", "sum of the risks of death", required=True),)


def risk(speed_kmh: float) -> float:
    """Return the probability of death.

    Examples
    --------
    >>> round(risk(50.0), 3)
    0.083
    """
    return float(1.0 / (1.0 + np.exp(6.9 - 0.090 * speed_kmh)))


def compute(case: Case) -> Values:
    """Return the risk of the first collision."""
    first = case.first_collision()
    return {
        "p_fatal_rosen2009": np.array([np.nan if hit is None else risk(3.6 * hit.ego_speed) for hit in first])
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the sum over the run's collisions."""
    return {"sum_p_fatal_rosen2009": float(np.nansum(columns["p_fatal_rosen2009"]))}
