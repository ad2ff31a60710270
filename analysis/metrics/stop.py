"""Whether the ego stood during the encounter, before it left the conflict area.

1 where its speed was at or below standing_speed_mps at some step.

Undefined: never.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
COLUMNS = (column.flag("ego_stopped", "the ego stood during the encounter", required=True),)


def compute(case: Case) -> Values:
    """Return whether the ego stood."""
    speed = case.run.egos.numbers["speed_mps"]
    limit = case.thresholds.standing_speed_mps
    return {
        "ego_stopped": np.array([bool((speed[rows] <= limit).any()) for rows in case.ego_rows], dtype=bool)
    }
