"""Encroachment time: how long each user was inside the conflict area.

ET = time of leaving − time of entering, for ego and pedestrian apart.

Undefined: empty without a conflict area, and for a user still inside when the recording ends.
"""

from __future__ import annotations

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "s"
WORSE = "neither"
SOURCE = "[SSAM2003], chapter 7"
COLUMNS = ("et_ego_s", "et_ped_s")
RUN_COLUMNS = ()


def compute(case: Case) -> Values:
    """Return both stays."""
    return {
        "et_ego_s": case.ego_leave - case.ego_enter,
        "et_ped_s": case.person_leave - case.person_enter,
    }
