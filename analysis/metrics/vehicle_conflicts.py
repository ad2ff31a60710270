"""Conflicts of egos with other vehicles, by kind.

Each is listed in vehicle_conflicts.csv. Counted are those with a TTC or PET below 1.5 s: vehicles behind the
ego are in the metric followers. TTC is that of the two rectangles at constant velocities; PET is the time
between the first one's body leaving ground and the second one's arriving there, where their directions cross
by 30 to 150 degrees.

Undefined: the smallest PET is empty where nobody crossed within 3 s. Taken to go straight on, vehicles in
bends may seem to be on a collision course with oncoming ones.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Values
from analysis.encounters.vehicle_conflicts import BESIDE, CROSSING, FOLLOWING, ONCOMING
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import LOW_PET_S, LOW_TTC_S

UNIT = "1"
WORSE = "higher"
SOURCE = "[Hayward1972]; [Allen1978]; kinds by angle after [SSAM2008]"
_COUNTED = {
    FOLLOWING: "with a vehicle that the ego follows",
    BESIDE: "with a vehicle beside the ego",
    ONCOMING: "with an oncoming vehicle",
    CROSSING: "with a vehicle that crosses the ego's way",
}
RUN_COLUMNS = (
    *(
        column.count(f"n_vehicle_conflicts_{kind}", f"TTC or PET below 1.5 s {words}", required=True)
        for kind, words in _COUNTED.items()
    ),
    column.at_least_0("min_vehicle_pet_s", "s", "smallest PET with a vehicle", worse="lower"),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the conflicts of each kind."""
    close = [one.kind for one in whole.vehicle_conflicts if one.min_ttc < LOW_TTC_S or one.pet < LOW_PET_S]
    pet = np.array([one.pet for one in whole.vehicle_conflicts])
    return {
        **{f"n_vehicle_conflicts_{kind}": close.count(kind) for kind in _COUNTED},
        "min_vehicle_pet_s": np.fmin.reduce(pet, initial=np.nan),
    }
