"""Exact time to collision in two dimensions.

TTC is the smallest t >= 0 at which the ego's rectangle and the pedestrian's disc touch if both keep
their velocity; the smallest one of the encounter is reported, with its time and both speeds then. After a
contact, time and speed of the ego are those of the contact; the speed of the pedestrian is still that at the
smallest TTC before, and empty without one.

Undefined: empty with ttc_status `no_collision_course` where the two would never touch, `not_entered`
for a person who never was on the crossing nor in the ego's path. 0 with status `collision` after a
contact. Steps with a standing ego, or with the person still at the kerb, do not count. Both are taken to go
straight on: for a turning ego that may predict a collision beside its path.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import TTC_LIMITS_S, in_name

UNIT = "s"
WORSE = "lower"
SOURCE = "[Hayward1972]; closed form for rectangle and disc: own derivation, see analysis/geometry.py"
COLUMNS = (
    column.at_least_0("min_ttc_s", "s", "smallest exact two-dimensional time to collision"),
    column.number("t_min_ttc_s", "s", "when it was"),
    column.text(
        "ttc_status",
        "why min_ttc_s has its value or has none",
        "ok",
        "no_collision_course",
        "not_entered",
        "collision",
        required=True,
    ),
    column.at_least_0("ego_speed_at_min_ttc_mps", "m/s", "speed of the ego at the smallest TTC"),
    column.at_least_0("ped_speed_at_min_ttc_mps", "m/s", "speed of the pedestrian at the smallest TTC"),
)
RUN_COLUMNS = (
    column.count("n_ttc_defined", "encounters with a TTC", required=True),
    *(
        column.count(f"n_ttc_lt_{in_name(limit)}", f"encounters with TTC below {limit:.1f} s", required=True)
        for limit in TTC_LIMITS_S
    ),
    column.at_least_0("min_ttc_s", "s", "smallest TTC"),
    column.at_least_0("p05_min_ttc_s", "s", "5th percentile of the encounters' defined smallest TTC"),
)


def compute(case: Case) -> Values:
    """Return the smallest TTC, its time, its status, and the speeds at that time."""
    low, at = case.samples.smallest(case.samples.ttc)
    status = np.where(np.isfinite(low), "ok", np.where(case.entered, "no_collision_course", "not_entered"))
    time = case.samples.time[np.minimum(at, max(len(case.samples) - 1, 0))]
    ego_speed = case.samples.ego_speed[at] if len(at) else time
    person_speed = case.samples.person_speed[at] if len(at) else time
    found = np.isfinite(low)
    time, ego_speed, person_speed = (
        np.where(found, values, np.nan) for values in (time, ego_speed, person_speed)
    )
    for contact in reversed(case.collisions()):
        i = contact.encounter
        low[i], time[i], ego_speed[i], status[i] = 0.0, contact.time, contact.ego_speed, "collision"
    return {
        "min_ttc_s": low,
        "t_min_ttc_s": time,
        "ttc_status": status,
        "ego_speed_at_min_ttc_mps": ego_speed,
        "ped_speed_at_min_ttc_mps": person_speed,
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count encounters below the limits; percentiles are those of the defined values."""
    ttc = np.asarray(columns["min_ttc_s"])
    known = ttc[np.isfinite(ttc)]
    return {
        "n_ttc_defined": len(known),
        **{f"n_ttc_lt_{in_name(limit)}": int((ttc < limit).sum()) for limit in TTC_LIMITS_S},
        "min_ttc_s": known.min() if len(known) else None,
        "p05_min_ttc_s": np.percentile(known, 5.0) if len(known) else None,
    }
