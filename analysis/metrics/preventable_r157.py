"""Whether a competent and careful driver could have stopped in time.

1 where the time to the conflict area at constant speed, at the instant the pedestrian steps on the
crossing (away from crossings: at the encounter's beginning), or at which the ego's sensors first tell of
him if that is later, is at least that driver's stopping
distance over speed: reaction r157_reaction_s, braking that rises to r157_deceleration_mps2 within
r157_ramp_s. Independent of what the controller did.

Undefined: empty without a conflict area, and where the ego was in it before he could be seen to enter; 0
where sensors told of him only then, or never.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values
from analysis.moments import stopping_distance, visible_entries

SCOPE = "encounter"
UNIT = "1"
WORSE = "neither"
SOURCE = "[R157], reference driver, after a transcription"
COLUMNS = ("preventable_r157",)
RUN_COLUMNS = ()


def compute(case: Case) -> Values:
    """Return 1, 0, or nan where it is undefined."""
    seen = visible_entries(case)
    limits = case.thresholds
    needed = stopping_distance(
        seen.ego_speed, limits.r157_reaction_s, limits.r157_deceleration_mps2, limits.r157_ramp_s
    )
    return {"preventable_r157": np.where(np.isnan(seen.time), np.nan, seen.distance >= needed)}
