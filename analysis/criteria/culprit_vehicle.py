"""The ego and the vehicle close to it that a failed criterion is about: who, when and where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from analysis.criteria.criterion import Cells
from analysis.criteria.culprit_alone import EgoAlone
from analysis.encounters.vehicle_conflicts import BESIDE, CROSSING, FOLLOWED, FOLLOWING, ONCOMING
from analysis.thresholds import DRAC_LIMIT_MPS2, LOW_TTC_S, in_name

_TTC, _PET, _DRAC = ("min_ttc_s", "s TTC"), ("pet_s", "s PET"), ("drac_max_mps2", "m/s² DRAC")
CLOSE: Mapping[str, tuple[str, tuple[tuple[str, str], ...]]] = {
    "n_follower_conflicts": (FOLLOWED, (_TTC,)),
    f"n_follower_ttc_lt_{in_name(LOW_TTC_S)}": (FOLLOWED, (_TTC,)),
    f"n_follower_drac_gt_{in_name(DRAC_LIMIT_MPS2)}": (FOLLOWED, (_DRAC,)),
    "follower_min_ttc_s": (FOLLOWED, (_TTC,)),
    "follower_max_drac_mps2": (FOLLOWED, (_DRAC,)),
    **{f"n_vehicle_conflicts_{kind}": (kind, (_TTC,)) for kind in (FOLLOWING, BESIDE, ONCOMING)},
    f"n_vehicle_conflicts_{CROSSING}": (CROSSING, (_TTC, _PET)),
    "min_vehicle_pet_s": (CROSSING, (_PET,)),
}
"""Metric of a run -> kind of conflict that it is about, and columns (with their words) of the worst one."""
_WHERE = {
    FOLLOWED: "behind",
    FOLLOWING: "ahead",
    BESIDE: "beside",
    ONCOMING: "oncoming",
    CROSSING: "crossing",
}


def of_conflict(metric: str, conflicts: Sequence[Cells]) -> EgoAlone | None:
    """Return the worst conflict with a vehicle; ``None`` if no conflict of the kind has a value.

    Parameters
    ----------
    metric
        One of :data:`CLOSE`.
    conflicts
        Rows of vehicle_conflicts.csv.
    """
    kind, told_by = CLOSE[metric]
    found = [
        (float(row[column]), words, row)
        for row in conflicts
        for column, words in told_by
        if row["kind"] == kind and row[column]
    ]
    if not found:
        return None
    choose = max if told_by == (_DRAC,) else min
    value, words, worst = choose(found, key=lambda one: one[0])
    place = f"{value:.2f} {words}, vehicle {worst['vehicle_id']} {_WHERE[kind]}"
    return EgoAlone(worst["ego_id"], float(worst["t_min_ttc_s"]), place, None)
