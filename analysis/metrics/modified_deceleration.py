"""Modified DRAC (MDRAC): DRAC after a reaction time.

As deceleration_to_avoid_collision with d − v PRT and T − PRT in place of d and T (movement along the
ego: closing speed / (2 (TTC − PRT))); PRT is mdrac_reaction_s and stands beside the value.

Undefined: empty with mdrac_status `unavoidable_at_PRT` where the ego is at the area before it reacts,
`not_entered`, `collision`.
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
SOURCE = "[SUMO-SSM]"
BEYOND = ("unavoidable_at_PRT", "collision")
"""Statuses without a value that are counted as above every limit, the worst one last."""
COLUMNS = (
    column.at_least_0("mdrac_max_mps2", "m/s^2", "the same after a reaction time"),
    column.at_least_0("mdrac_prt_s", "s", "that reaction time", required=True),
    column.text(
        "mdrac_status",
        "why mdrac_max_mps2 has its value or has none",
        "ok",
        "unavoidable_at_PRT",
        "not_entered",
        "collision",
        required=True,
    ),
)
RUN_COLUMNS = (
    column.count(
        "n_mdrac_gt_3p4",
        "encounters with MDRAC above 3.4 m/s^2 or unavoidable, or with a collision",
        required=True,
    ),
)


def compute(case: Case) -> Values:
    """Return the largest MDRAC, the reaction time and the status."""
    reaction = case.thresholds.mdrac_reaction_s
    high, _ = case.samples.largest(drac(case, reaction))
    bounded = np.where(np.isposinf(high), "unavoidable_at_PRT", "ok")
    status = np.where(case.entered, bounded, "not_entered")
    for contact in case.collisions():
        status[contact.encounter] = "collision"
    return {
        "mdrac_max_mps2": np.where(status == "ok", np.maximum(high, 0.0), np.nan),
        "mdrac_prt_s": np.full(len(case), reaction),
        "mdrac_status": status,
    }


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count encounters that needed more than 3.4 m/s^2, the unavoidable ones and collisions included."""
    status = np.asarray(columns["mdrac_status"])
    beyond = np.isin(status, BEYOND)
    return {"n_mdrac_gt_3p4": int((beyond | (np.asarray(columns["mdrac_max_mps2"]) > DRAC_LIMIT_MPS2)).sum())}
