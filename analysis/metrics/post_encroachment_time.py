"""Post-encroachment time over the conflict area.

PET is the time between the first user leaving the conflict area (what the ego's body and the
pedestrian's disc both sweep) and the second one entering it. Footprint PET, as in SSAM, is larger by up
to disc radius over ego speed.

Undefined: empty with pet_status `no_crossing` where their paths share no ground, `interleaved` where
both were inside at once without touching, `censored` where the recording ends before the first has
left. 0 with status `collision` after a contact.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "s"
WORSE = "lower"
SOURCE = "[Allen1978]; conflict area as in [SUMO-SSM]"
COLUMNS = ("pet_area_s", "pet_status")
RUN_COLUMNS = ("n_pet_defined", "n_pet_lt_1p0", "n_pet_lt_1p5", "n_pet_lt_3p0", "n_pet_lt_5p0", "min_pet_s")


def compute(case: Case) -> Values:
    """Return PET and its status."""
    pet = case.post_encroachment()
    status = []
    hit = {contact.encounter for contact in case.collisions()}
    for i, one in enumerate(case.encounters):
        if i in hit:
            status.append("collision")
        elif one.area is None:
            status.append("censored" if one.censored else "no_crossing")
        elif np.isfinite(pet[i]):
            status.append("ok")
        else:
            interleaved = one.area.time_between < 0.0 and np.isfinite(one.area.time_between)
            status.append("interleaved" if interleaved else "censored")
    return {"pet_area_s": pet, "pet_status": status}


def summarise(case: Case, columns: Values) -> Values:
    """Count encounters below the limits."""
    pet = np.asarray(columns["pet_area_s"])
    known = pet[np.isfinite(pet)]
    counts = {
        f"n_pet_lt_{text}": int((known < limit).sum())
        for text, limit in (("1p0", 1.0), ("1p5", 1.5), ("3p0", 3.0), ("5p0", 5.0))
    }
    return {
        "n_pet_defined": len(known),
        **counts,
        "min_pet_s": known.min() if len(known) else None,
    }
