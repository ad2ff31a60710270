"""Risk of a severe injury or worse (MAIS3+ or fatal), after Monfort and Mueller.

P = 1 / (1 + exp(−eta)), eta = −0.460 + 0.091 (v − 42.79) + 0.039 (h − 85.25)
+ 0.002 (v − 42.79)(h − 85.25), with the impact speed v [km/h] and the height h of the hood's leading edge
(hood_leading_edge_cm), at the mean of sex and age.

Undefined: empty without a collision.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "[MonfortMueller2025], coefficients after code that cites its Table 4"
CURVE = (
    "P = 1 / (1 + exp(-eta)), eta = -0.460 + 0.091 (v - 42.79) + 0.039 (h - 85.25) "
    "+ 0.002 (v - 42.79) (h - 85.25), v in km/h, h = hood_leading_edge_cm"
)
COLUMNS = (column.share("p_mais3_mm2025", "risk of MAIS3+ or death at the impact speed"),)


def risk(speed_kmh: float, leading_edge_cm: float) -> float:
    """Return the probability of MAIS3+ or death.

    Examples
    --------
    >>> round(risk(50.0, 75.0), 3)
    0.413
    """
    v, h = speed_kmh - 42.79, leading_edge_cm - 85.25
    eta = -0.460 + 0.091 * v + 0.039 * h + 0.002 * v * h
    return float(1.0 / (1.0 + np.exp(-eta)))


def compute(case: Case) -> Values:
    """Return the risk of the first collision."""
    edge = case.thresholds.hood_leading_edge_cm
    first = case.first_collision()
    return {
        "p_mais3_mm2025": np.array(
            [np.nan if hit is None else risk(3.6 * hit.ego_speed, edge) for hit in first]
        )
    }
