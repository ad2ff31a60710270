"""Deceleration rate to avoid a crash (DRAC), largest over the encounter.

With the ego at speed v, d its way to the predicted conflict area and T the time until the pedestrian
has left it at constant velocity: 0 for d >= v T; 2 (v − d/T) / T for v T / 2 <= d < v T; v^2 / (2 d)
for d < v T / 2, where slowing down is not enough and the ego has to stop. A pedestrian moving along
the ego's direction: closing speed^2 / (2 gap). 0 where the ego clears the area before the
pedestrian enters.

Undefined: empty with drac_status `unbounded` where no deceleration would do (the ego is at the area with
the pedestrian inside), `not_entered` for a person who never enters, `collision` after a contact.
SUMO's device has the middle branch only, and takes the smaller value of both users: not comparable.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.required_deceleration import drac
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column
from analysis.thresholds import DRAC_LIMIT_MPS2

UNIT = "m/s^2"
WORSE = "higher"
SOURCE = "[SUMO-SSM] for the middle branch; the others: own derivation, checked by brute force"
BEYOND = ("unbounded", "collision")
"""Statuses without a value that are counted as above every limit, the worst one last."""
COLUMNS = (
    column.at_least_0("drac_max_mps2", "m/s^2", "largest deceleration needed to avoid the collision"),
    column.text(
        "drac_status",
        "why drac_max_mps2 has its value or has none",
        "ok",
        "unbounded",
        "not_entered",
        "collision",
        required=True,
    ),
)
RUN_COLUMNS = (
    column.count(
        "n_drac_gt_3p4",
        "encounters with DRAC above 3.4 m/s^2 or unbounded, or with a collision",
        required=True,
    ),
)


def compute(case: Case) -> Values:
    """Return the largest DRAC and its status."""
    high, _ = case.samples.largest(drac(case, 0.0))
    status = np.where(case.entered, np.where(np.isposinf(high), "unbounded", "ok"), "not_entered")
    for contact in case.collisions():
        high[contact.encounter], status[contact.encounter] = np.inf, "collision"
    return {"drac_max_mps2": np.where(status == "ok", np.maximum(high, 0.0), np.nan), "drac_status": status}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count encounters that needed more than 3.4 m/s^2, the unbounded ones and collisions included."""
    status = np.asarray(columns["drac_status"])
    beyond = np.isin(status, BEYOND)
    return {"n_drac_gt_3p4": int((beyond | (np.asarray(columns["drac_max_mps2"]) > DRAC_LIMIT_MPS2)).sum())}
