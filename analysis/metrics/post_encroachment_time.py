"""Post-encroachment time over the conflict area.

PET is the time between the first user leaving the conflict area (what the ego's body and the
pedestrian's disc both sweep) and the second one entering it. Footprint PET, as in SSAM, is larger by up
to disc radius over ego speed.

Undefined: empty with pet_status `no_crossing` where they shared no ground within visit_pairing_s,
`interleaved` where both were inside at once without touching, `censored` where the recording ends before
they shared ground or before the first has left. 0 with status `collision` after a contact.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.conflict_area import ConflictArea
from analysis.encounters.finding import Encounter
from analysis.encounters.whole_run import WholeRun
from analysis.recording.fine_grid import Grid
from analysis.tables import column
from analysis.thresholds import PET_LIMITS_S, in_name

UNIT = "s"
WORSE = "lower"
SOURCE = "[Allen1978]; conflict area as in [SUMO-SSM]"
COLUMNS = (
    column.at_least_0("pet_area_s", "s", "post-encroachment time over the conflict area"),
    column.text(
        "pet_status",
        "why pet_area_s has its value or has none",
        "ok",
        "no_crossing",
        "interleaved",
        "censored",
        "collision",
        required=True,
    ),
)
RUN_COLUMNS = (
    column.count("n_pet_defined", "encounters with a PET", required=True),
    *(
        column.count(f"n_pet_lt_{in_name(limit)}", f"encounters with PET below {limit:.1f} s", required=True)
        for limit in PET_LIMITS_S
    ),
    column.at_least_0("min_pet_s", "s", "smallest PET"),
)


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
            status.append("interleaved" if _both_inside(one, one.area, case.grid) else "censored")
    return {"pet_area_s": pet, "pet_status": status}


def _both_inside(one: Encounter, area: ConflictArea, grid: Grid) -> bool:
    """Return whether the second was seen to enter before the first had left, or the recording of it ended."""
    if np.isnan(area.ego.leave) and np.isnan(area.person.leave):
        return False
    ends = [
        float(grid.time[track.first + visit.last]) if np.isnan(visit.leave) else visit.leave
        for track, visit in ((one.ego, area.ego), (one.person, area.person))
    ]
    return max(area.ego.enter, area.person.enter) < min(ends)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count encounters below the limits."""
    pet = np.asarray(columns["pet_area_s"])
    known = pet[np.isfinite(pet)]
    return {
        "n_pet_defined": len(known),
        **{f"n_pet_lt_{in_name(limit)}": int((known < limit).sum()) for limit in PET_LIMITS_S},
        "min_pet_s": known.min() if len(known) else None,
    }
