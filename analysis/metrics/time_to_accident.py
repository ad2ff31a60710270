"""Time to accident (TA): TTC at the instant when the ego's evasive action begins.

Evasive action begins with the first step of the encounter in which the ego brakes harder than
evasive_deceleration_mps2. Without one, the instant of the smallest TTC is taken (evasive_status `none`).

Undefined: empty where there is no collision course at that instant, or the person is not on the
crossing yet.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.moments import evasions
from analysis.tables import column

UNIT = "s"
WORSE = "lower"
SOURCE = "[SwedishTCT2018]; its severity curve is not used"
COLUMNS = (
    column.at_least_0("time_to_accident_s", "s", "TTC when the ego's evasive action begins"),
    column.number("evasive_t_s", "s", "beginning of the ego's evasive action"),
    column.text("evasive_status", "whether there was one", "braked", "none", required=True),
)


def compute(case: Case) -> Values:
    """Return TA and the beginning of the evasive action."""
    found = evasions(case)
    return {
        "time_to_accident_s": found.ttc,
        "evasive_t_s": np.where(found.braked, found.time, np.nan),
        "evasive_status": np.where(found.braked, "braked", "none"),
    }
