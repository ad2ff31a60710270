"""Time to collision along the ego's own direction.

TTC-1D = gap / closing speed for a pedestrian inside the strip straight ahead of the ego, the gap taken
from the front bumper to the disc and the closing speed along the ego; the smallest one is reported.

Undefined: empty where no pedestrian is ever ahead inside the strip while the ego closes in; 0 after a
contact.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "[Hayward1972]; [SUMO-SSM]"
COLUMNS = (column.at_least_0("min_ttc_1d_s", "s", "smallest time to collision along the ego's direction"),)


def compute(case: Case) -> Values:
    """Return the smallest one-dimensional TTC."""
    samples = case.samples
    gap = samples.x - samples.half_length - samples.radius
    closing = -samples.relative_x_speed
    ahead = samples.exposed & (np.abs(samples.y) <= samples.half_width + samples.radius)
    ahead &= (closing > 0.0) & (gap > 0.0)
    ttc = np.where(ahead, gap / np.where(ahead, closing, 1.0), np.inf)
    low, _ = samples.smallest(ttc)
    for contact in case.collisions():
        low[contact.encounter] = 0.0
    return {"min_ttc_1d_s": low}
