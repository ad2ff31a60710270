"""Encroachment time: how long each user was inside the conflict area.

ET = time of leaving − time of entering, for ego and pedestrian apart.

Undefined: empty without a conflict area, and for a user still inside when the recording ends.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "s"
WORSE = "neither"
SOURCE = "[SSAM2003], chapter 7"
COLUMNS = (
    column.at_least_0("et_ego_s", "s", "time of the ego in the conflict area"),
    column.at_least_0("et_ped_s", "s", "time of the pedestrian in the conflict area"),
)


def compute(case: Case) -> Values:
    """Return the duration of each user's stay."""
    return {
        "et_ego_s": case.ego_leave - case.ego_enter,
        "et_ped_s": case.person_leave - case.person_enter,
    }
