"""Conflicting speed (CS): the ego's speed at the instant when its evasive action begins.

The instant is that of time_to_accident.

Undefined: empty without evasive action and without a collision course.
"""

from __future__ import annotations

from analysis.case import Case, Values
from analysis.moments import evasions

SCOPE = "encounter"
UNIT = "m/s"
WORSE = "higher"
SOURCE = "[SwedishTCT2018]"
COLUMNS = ("conflicting_speed_mps",)
RUN_COLUMNS = ()


def compute(case: Case) -> Values:
    """Return the conflicting speed."""
    return {"conflicting_speed_mps": evasions(case).ego_speed}
