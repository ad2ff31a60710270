"""Rear-end risk of the vehicles behind egos.

A vehicle follows an ego while it drives behind it in about the same direction (within 30 degrees) and their
bodies overlap across. TTC is that of the two rectangles at constant velocities; DRAC is the closing speed
squared over twice the gap between the bumpers. Every follower of a conflict in vehicle_conflicts.csv counts,
whoever drives it; an ego behind another ego is one too.

Undefined: the smallest TTC and the largest DRAC are empty without a follower in conflict. Followers who are
further from the ego than the recording reaches do not count.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Values
from analysis.encounters.vehicle_conflicts import FOLLOWED
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import DRAC_LIMIT_MPS2, LOW_TTC_S, in_name

UNIT = "1"
WORSE = "higher"
SOURCE = "[Hayward1972]; DRAC as in [SSAM2003]"
RUN_COLUMNS = (
    column.count("n_follower_conflicts", "vehicles behind an ego that came close to it", required=True),
    column.count(
        f"n_follower_ttc_lt_{in_name(LOW_TTC_S)}", f"those with a TTC below {LOW_TTC_S:.1f} s", required=True
    ),
    column.count(
        f"n_follower_drac_gt_{in_name(DRAC_LIMIT_MPS2)}",
        f"those with a DRAC above {DRAC_LIMIT_MPS2:.1f} m/s^2",
        required=True,
    ),
    column.at_least_0("follower_min_ttc_s", "s", "smallest TTC of a vehicle behind an ego", worse="lower"),
    column.at_least_0("follower_max_drac_mps2", "m/s^2", "largest DRAC of a vehicle behind an ego"),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the followers of egos in conflict, and return the extremes."""
    followers = [one for one in whole.vehicle_conflicts if one.kind == FOLLOWED]
    ttc = np.array([one.min_ttc for one in followers])
    drac = np.array([one.max_drac for one in followers])
    return {
        "n_follower_conflicts": len(followers),
        f"n_follower_ttc_lt_{in_name(LOW_TTC_S)}": int((ttc < LOW_TTC_S).sum()),
        f"n_follower_drac_gt_{in_name(DRAC_LIMIT_MPS2)}": int((drac > DRAC_LIMIT_MPS2).sum()),
        "follower_min_ttc_s": ttc.min(initial=np.inf),
        "follower_max_drac_mps2": np.fmax.reduce(drac, initial=np.nan),
    }
