"""Delta-V of the pedestrian: the change of their speed in a perfectly inelastic collision.

m_ego / (m_ego + m_ped) times the relative speed at the smallest time to collision, TTC (at first contact
after a collision), with ego_mass_kg and pedestrian_mass_kg.

Undefined: empty without a collision course.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.tables import column

UNIT = "m/s"
WORSE = "higher"
SOURCE = "[SSAM2008], with masses in place of areas"
COLUMNS = (
    column.at_least_0("delta_v_ped_mps", "m/s", "change of the pedestrian's speed in an inelastic collision"),
)


def compute(case: Case) -> Values:
    """Return the pedestrian's change of speed."""
    samples, limits = case.samples, case.thresholds
    low, at = samples.smallest(samples.ttc)
    relative = np.hypot(samples.relative_x_speed, samples.y_speed)
    value = np.where(np.isfinite(low), relative[at] if len(at) else low, np.nan)
    for contact in reversed(case.collisions()):
        value[contact.encounter] = contact.relative_speed
    share = limits.ego_mass_kg / (limits.ego_mass_kg + limits.pedestrian_mass_kg)
    return {"delta_v_ped_mps": share * value}
