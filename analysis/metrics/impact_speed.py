"""Speed of the ego at first contact.

Undefined: empty without a collision.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "km/h"
WORSE = "higher"
SOURCE = "[R152], after a transcription"
COLUMNS = ("impact_speed_kmh",)
RUN_COLUMNS = ()


def compute(case: Case) -> Values:
    """Return the impact speed of the first collision."""
    first = case.first_collision()
    return {
        "impact_speed_kmh": np.array([np.nan if hit is None else 3.6 * hit.ego_speed for hit in first]),
    }
