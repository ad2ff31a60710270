"""Conflicting speed (CS): the ego's speed at the instant when its evasive action begins.

The instant is that of time_to_accident.

Undefined: empty without evasive action and without a collision course.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import evasions
from analysis.tables import column

UNIT = "m/s"
WORSE = "higher"
SOURCE = "[SwedishTCT2018]"
COLUMNS = (
    column.at_least_0("conflicting_speed_mps", "m/s", "speed of the ego when its evasive action begins"),
)


def compute(case: Case) -> Values:
    """Return the conflicting speed."""
    return {"conflicting_speed_mps": evasions(case).ego_speed}
