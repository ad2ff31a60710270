"""Distance of closest encounter (DCE) and time to it (TTCE).

At each sample, the smallest distance between the surfaces that is still to come at constant velocities,
and the time until then; the smallest DCE of the encounter and its TTCE at the first sample that has it
are reported. If the two are already separating, DCE is the present distance and TTCE is 0.

Undefined: empty for a person who never enters. 0 on a collision course and after a contact.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.geometry import closest_approach
from analysis.tables import column

UNIT = "m"
WORSE = "lower"
SOURCE = "[CriticalityMetrics]"
COLUMNS = (
    column.at_least_0("dce_m", "m", "smallest predicted distance of closest encounter"),
    column.at_least_0("ttce_s", "s", "predicted time to it"),
)


def compute(case: Case) -> Values:
    """Return the smallest predicted distance and its time."""
    samples = case.samples
    exposed = samples.exposed
    dce, ttce = np.full(len(samples), np.inf), np.full(len(samples), np.nan)
    dce[exposed], ttce[exposed] = closest_approach(
        samples.x[exposed],
        samples.y[exposed],
        samples.relative_x_speed[exposed],
        samples.y_speed[exposed],
        samples.half_length[exposed],
        samples.half_width[exposed],
        samples.radius[exposed],
    )
    # Equal distances on a steady course are equal only up to rounding; the first of them counts.
    low, at = samples.smallest(np.round(dce, 6))
    when = np.where(np.isfinite(low), ttce[at] if len(at) else low, np.nan)
    for contact in case.collisions():
        low[contact.encounter], when[contact.encounter] = 0.0, 0.0
    return {"dce_m": low, "ttce_s": when}
