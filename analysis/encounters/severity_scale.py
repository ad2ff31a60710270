"""The severity scale: collision, severe, serious, slight, none."""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case

LEVELS = ("none", "slight", "serious", "severe", "collision")
CONFLICTS = LEVELS[2:]
"""Levels that make an encounter a conflict."""


def severity_levels(case: Case) -> list[str]:
    """Return each encounter's level: the more severe one of its TTC and its PET.

    Encounters with pedestrians who wait and never enter are ``none``.
    """
    limits = case.thresholds
    ttc, pet = case.smallest_ttc(), case.post_encroachment()
    level = np.zeros(len(case), dtype=np.int64)
    for rank, ttc_limit, pet_limit in (
        (1, limits.severity_ttc_slight_s, limits.severity_pet_slight_s),
        (2, limits.severity_ttc_serious_s, limits.severity_pet_serious_s),
        (3, limits.severity_ttc_severe_s, limits.severity_pet_severe_s),
    ):
        level[(ttc < ttc_limit) | (pet < pet_limit)] = rank
    level[~case.entered] = 0
    for contact in case.collisions():
        level[contact.encounter] = 4
    return [LEVELS[rank] for rank in level.tolist()]
