"""Speed of the ego at first contact.

Undefined: empty without a collision.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "km/h"
WORSE = "higher"
SOURCE = "[R152], after a transcription"
COLUMNS = (column.at_least_0("impact_speed_kmh", "km/h", "speed of the ego at first contact"),)


def compute(case: Case) -> Values:
    """Return the impact speed of the first collision."""
    first = case.first_collision()
    return {
        "impact_speed_kmh": np.array([np.nan if hit is None else 3.6 * hit.ego_speed for hit in first]),
    }
